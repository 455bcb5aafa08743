// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/program_conversation.h"

namespace vernier::internal {

/// What such a program is told when it starts, and how long it may take.
struct ProgramStart {
  std::function<std::string()> lines;  ///< that it answers with {"ready": true}
  std::string of_what;                 ///< they are, in messages: "the map"
  double limit_s = 10;
};

/// A program that answers questions, line by line, for as long as it behaves: one that ends, is
/// late or answers nonsense is started again with the next question, and after three failures one
/// after the other left alone. Not for several threads at once.
class AnsweringProgram {
 public:
  /// Throws Error if it cannot be started. Whether it got ready, the first question shows.
  AnsweringProgram(std::vector<std::string> words, ProgramStart start, double time_limit_s);

  /// Asks, if the program runs, and gives its line to `take`, which throws Error for nonsense.
  /// Whether there was an answer that was taken; if not, failure() says why.
  bool ask(const std::function<std::string()>& question,
           const std::function<void(std::string_view)>& take);

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
  int failures_ = 0;  // one after the other
  std::string failure_;
};

}  // namespace vernier::internal
