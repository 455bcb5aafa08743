// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace vernier::test {

/// Where the larger data sets are, by the environment variable VERNIER_DATA; nothing where unset.
inline std::optional<std::filesystem::path> data_folder() {
  const char* folder = std::getenv("VERNIER_DATA");
  if (!folder || !std::filesystem::is_directory(folder)) return std::nullopt;
  return folder;
}

}  // namespace vernier::test
