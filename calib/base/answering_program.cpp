// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/answering_program.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/json_reader.h"
#include "calib/base/program_conversation.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"

namespace vernier::internal {

namespace {

using Outcome = ProgramConversation::Outcome;

constexpr int most_failures = 3;

/// What went wrong, with what the program itself says of it.
std::string fault(Outcome outcome, double limit_s, const ProgramConversation& program) {
  std::string what;
  if (outcome == Outcome::ended) what = "has ended without an answer";
  if (outcome == Outcome::timed_out) what = fmt::format("gives no answer within {:g} s", limit_s);
  if (outcome == Outcome::too_long) what = "answers with a line of more than 16 MB";
  const std::string complaint = program.last_complaint();
  return complaint.empty() ? what : what + " (" + complaint + ")";
}

bool says_ready(std::string_view answer) {
  try {
    const auto json = parse_json(answer, "answer");
    return json.is_object() && json.contains("ready") && json["ready"] == true;
  } catch (const Error&) {  // no JSON
    return false;
  }
}

}  // namespace

AnsweringProgram::AnsweringProgram(std::vector<std::string> words,
                                   ProgramStart start,
                                   double time_limit_s)
    : words_(std::move(words)), start_(std::move(start)), time_limit_s_(time_limit_s) {
  this->start();
}

/// Starts the program and tells it what there is; without program_ afterwards it did not get ready,
/// and failure_ says why.
void AnsweringProgram::start() {
  auto program = std::make_unique<ProgramConversation>(words_);
  std::string answer;
  const Outcome outcome = program->ask(start_.lines(), start_.limit_s, answer);
  if (outcome != Outcome::line) {
    failure_ = fault(outcome, start_.limit_s, *program);
  } else if (!says_ready(answer)) {
    failure_ = "answers " + start_.of_what + " with " + in_quotes(answer) +
               " instead of {\"ready\": true}";
  } else {
    program_ = std::move(program);
  }
}

bool AnsweringProgram::ask(const std::function<std::string()>& question,
                           const std::function<void(std::string_view)>& take) {
  if (failures_ >= most_failures) return false;
  if (!program_ && failures_ > 0) start();  // that the first start failed is told here
  ++failures_;
  if (!program_) return false;
  std::string line;
  const std::string asked = question();
  bool out_of_turn = program_->has_printed_more();
  const Outcome outcome = out_of_turn ? Outcome::line : program_->ask(asked, time_limit_s_, line);
  failure_ = fault(outcome, time_limit_s_, *program_);
  out_of_turn = out_of_turn || (outcome == Outcome::line && program_->has_printed_more());
  if (out_of_turn) {
    failure_ = "prints more than one line for a question, so that answers and questions part";
  } else if (outcome == Outcome::line) {
    try {
      take(line);
      failures_ = 0;
      return true;
    } catch (const Error& error) {
      failure_ = "answers nonsense: " + error.place() + " " + error.fault();
    }
  }
  program_.reset();  // what it prints later would be taken for the next answer
  return false;
}

}  // namespace vernier::internal
