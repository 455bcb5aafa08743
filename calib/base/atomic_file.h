// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vernier::internal {

/// Writes `content` to `file`, which appears whole, by rename, or not at all: an interrupted run
/// leaves the old file as it was. Throws Error where the folder is missing or not writable.
void write_atomically(const std::filesystem::path& file, std::string_view content);

/// The same for files that belong together, each a name and its content: all of them are written
/// beside their places before the first rename, so that what can go wrong leaves every old file.
void write_atomically(
    const std::vector<std::pair<std::filesystem::path, std::string>>& named_contents);

/// The whole content of a file. Throws Error where it cannot be read.
std::string read_whole(const std::filesystem::path& file);

}  // namespace vernier::internal
