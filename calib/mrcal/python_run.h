// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vernier {

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
  int exit_code = -1;  ///< -1: it was not there or was ended by a signal
  std::string output, complaint;
};

/// Runs a program, found by the path, with nothing on its standard input; no shell takes part.
ProgramRun run_program(const std::vector<std::string>& words);

}  // namespace vernier
