// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/json_node.h"
#include "calib/base/program_conversation.h"

namespace vernier::internal {

/// Whether a program's line says {"ready": true}, whatever it says besides.
bool says_ready(std::string_view line);

/// What a program's line answers to the question with this number, without the number. Throws Error
/// if the line is no JSON, or not the answer to that question.
nlohmann::ordered_json numbered_answer(std::string_view line, std::uint64_t asked);

/// What such a program is told when it starts, and how long it may take.
struct ProgramStart {
  std::function<std::string()> lines;  ///< that it answers with {"ready": true}
  std::string of_what;                 ///< they are, in messages: "the map"
  double limit_s = 10;
};

/// A program that answers questions, a line of JSON each, for as long as it behaves: one that ends,
/// is late or answers nonsense is started again with the next question, and after three failures
/// one after the other left alone. Questions have numbers, "question" from 1, which their answers
/// repeat: a line too many is not taken for the answer to the next question, whenever it comes.
/// Not for several threads at once.
class AnsweringProgram {
 public:
  /// Throws Error if it cannot be started. Whether it got ready, the first question shows.
  AnsweringProgram(std::vector<std::string> words, ProgramStart start, double time_limit_s);

  /// Asks, if the program runs, and gives its answer without the number to `take`, which throws
  /// Error for nonsense. The question is an object. Whether there was an answer that was taken; if
  /// not, failure() says why.
  bool ask(const std::function<nlohmann::ordered_json()>& question,
           const std::function<void(const JsonNode&)>& take);

  /// The last one, as a predicate of the program: "has ended without an answer".
  const std::string& failure() const { return failure_; }

  /// CPU time of the program that runs, seconds; 0 if none does.
  double cpu_s() const { return program_ ? program_->cpu_s() : 0; }

 private:
  void start();

  std::vector<std::string> words_;
  ProgramStart start_;
  double time_limit_s_;
  std::unique_ptr<ProgramConversation> program_;
  std::uint64_t asked_ = 0;  // the number of the last question
  int failures_ = 0;         // one after the other
  std::string failure_;
};

}  // namespace vernier::internal
