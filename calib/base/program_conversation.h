// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/program_stream.h"

namespace vernier::internal {

/// A running program that answers lines with lines: what is sent is its standard input, what it
/// prints is its standard output. It is started without a shell in a process group of its own,
/// inherits no other descriptor and no changed signal, and is killed with its children by the
/// destructor. Not for several threads at once.
class ProgramConversation {
 public:
  /// Searches the program in PATH. Throws Error, naming it, if it cannot be started.
  explicit ProgramConversation(const std::vector<std::string>& words);
  ~ProgramConversation();
  ProgramConversation(const ProgramConversation&) = delete;
  ProgramConversation& operator=(const ProgramConversation&) = delete;

  enum class Outcome {
    line,       ///< it answered
    ended,      ///< it closed its output or ended
    timed_out,  ///< no whole line within the time
    too_long,   ///< a line of more than `longest_line` bytes
  };

  /// Sends lines, each with its end, and waits for one line in answer. What it prints before is
  /// kept for later answers. Does not throw.
  Outcome ask(std::string_view lines, double time_limit_s, std::string& answer);

  /// CPU time of the program so far, seconds, all its threads; children that it started only when
  /// it has waited for them. 0 if the system does not tell.
  double cpu_s() const;

  /// The last line that it wrote to standard error, at most 300 bytes; empty if there is none.
  std::string last_complaint() const;

  static constexpr std::size_t longest_line = 16'000'000;

 private:
  bool take_line(std::string& answer);
  static void read_from(ProgramStream& stream, std::string& to, std::size_t most_kept);

  pid_t child_ = 0;
  ProgramStream input_, output_, error_output_;
  std::string pending_, complaints_;
  std::size_t searched_ = 0;  // bytes of pending_ that hold no end of line
};

}  // namespace vernier::internal
