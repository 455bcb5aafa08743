// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vernier::internal {

/// A folder of its own below the system's temporary one, gone with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();  ///< throws Error where none can be made
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// How a program ended and what it wrote.
struct ProgramRun {
  int exit_code = -1;      ///< -1: it was not there, was ended by a signal or took too long
  int signal = 0;          ///< that ended it; 0: none
  int start_error = 0;     ///< errno of why it could not be run; 0: it was
  bool timed_out = false;  ///< it was ended because of the time limit
  std::string output, error_output;

  /// The last line that it wrote, of its complaint if there is one, on one line of text.
  std::string last_output_line() const;
};

/// Runs a program, found by the path, with nothing on its standard input; no shell takes part. With
/// a time limit (0: none) it is ended after that, and what it started too: it then runs in a
/// process group of its own, which the terminal's interrupt does not reach.
ProgramRun run_program(const std::vector<std::string>& words, double time_limit_s = 0);

}  // namespace vernier::internal
