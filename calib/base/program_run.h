// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spawn.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace vernier::internal {

/// A temporary folder in TMPDIR, or in /tmp if that is not set; removed by the destructor.
class TemporaryFolder {
 public:
  TemporaryFolder();  ///< throws Error, naming TMPDIR, if it cannot be made
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file in the folder. Throws Error, naming TMPDIR, if it cannot.
  std::filesystem::path write(const std::string& name, std::string_view content) const;

 private:
  std::filesystem::path path_;
};

/// The words of a command line: separated by blanks, with quotes and backslashes as in a shell, and
/// nothing else of it. Throws Error(`place`) for an unclosed quote.
std::vector<std::string> command_words(const std::string& command, const std::string& place);

/// Starts a program, searched in PATH, without a shell, with usual signals and in a process group
/// of its own, and notes it (unfinished_work.h). It inherits no descriptor but what `actions` gives
/// it as the first three. Returns errno.
int spawn_program(const std::vector<std::string>& words,
                  posix_spawn_file_actions_t& actions,
                  pid_t& child);

/// Exit state and output of a program.
struct ProgramRun {
  int exit_code = -1;      ///< -1: not found, ended by a signal or timed out
  int signal = 0;          ///< that terminated it; 0: none
  int start_error = 0;     ///< errno if it could not be started; 0: started
  bool timed_out = false;  ///< killed at the time limit
  std::string output, error_output;

  /// The last line of its standard error, or of its standard output if that is empty.
  std::string last_output_line() const;
};

/// Runs a program, searched in PATH, with empty standard input and without a shell. It inherits no
/// descriptor and no changed signal. When the time limit (0: none) expires, the program and its
/// children are killed.
ProgramRun run_program(const std::vector<std::string>& words, double time_limit_s = 0);

}  // namespace vernier::internal
