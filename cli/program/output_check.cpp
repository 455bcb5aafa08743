// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/output_check.h"

#include "calib/error.h"

namespace vernier::cli {

void check_output_is_not_input(const std::vector<std::filesystem::path>& inputs,
                               const std::filesystem::path& output) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code not_there;
    if (!std::filesystem::equivalent(input, output, not_there)) continue;
    throw Error(output.string(), "is an input and would be overwritten", "name another output");
  }
}

void check_different(const std::string& option,
                     const std::filesystem::path& file,
                     const std::filesystem::path& other) {
  std::error_code unknown;
  const auto whole = [&](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, unknown), unknown);
  };
  if (whole(file) != whole(other)) return;
  throw Error(option, file.string() + " is already used by another output", "name another file");
}

}  // namespace vernier::cli
