// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/answering_program.h"

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/json_node.h"
#include "calib/base/json_reader.h"
#include "calib/base/program_conversation.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"

namespace vernier::internal {

namespace {

using Outcome = ProgramConversation::Outcome;
using Json = nlohmann::ordered_json;

constexpr const char* number_key = "question";
constexpr const char* answer_place = "answer:";

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

}  // namespace

bool says_ready(std::string_view line) {
  try {
    const auto json = parse_json(line, "answer");
    return json.is_object() && json.contains("ready") && json["ready"] == true;
  } catch (const Error&) {  // no JSON
    return false;
  }
}

Json numbered_answer(std::string_view line, std::uint64_t asked) {
  Json json = parse_json(line, "answer");
  const JsonNode answer(json, answer_place);
  if (!answer.has(number_key)) {
    throw Error(
        answer.place(),
        fmt::format("does not repeat the number of its question, \"{}\": {}", number_key, asked),
        "");
  }
  const Json number = answer.at(number_key).json();
  if (number != asked) {
    const bool earlier = number.is_number_unsigned() && number < asked;
    throw Error(answer.place(),
                fmt::format("is for question {} where {} was asked{}", in_quotes(number.dump()),
                            asked, earlier ? ": more than one line for a question" : ""),
                "");
  }
  json.erase(number_key);
  return json;
}

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

bool AnsweringProgram::ask(const std::function<Json()>& question,
                           const std::function<void(const JsonNode&)>& take) {
  if (failures_ >= most_failures) return false;
  if (!program_ && failures_ > 0) start();  // that the first start failed is told here
  ++failures_;
  if (!program_) return false;
  Json asked = question();
  asked[number_key] = ++asked_;
  std::string line;
  const Outcome outcome = program_->ask(asked.dump() + "\n", time_limit_s_, line);
  failure_ = fault(outcome, time_limit_s_, *program_);
  if (outcome == Outcome::line) {
    try {
      const Json answer = numbered_answer(line, asked_);
      take(JsonNode(answer, answer_place));
      failures_ = 0;
      return true;
    } catch (const Error& error) {
      failure_ = "answers nonsense: " + error.place() + " " + error.fault();
    }
  }
  program_.reset();  // what it prints later is no answer
  return false;
}

}  // namespace vernier::internal
