// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vernier::internal {

/// Writes `content` to `file` atomically (temporary file and rename): an interrupted run leaves the
/// old file unchanged. Throws Error if the folder is missing or not writable.
void write_atomically(const std::filesystem::path& file, std::string_view content);

/// The same for several files, each a name and its content: all temporary files are written before
/// the first rename, so a failed write leaves every old file unchanged.
void write_atomically(
    const std::vector<std::pair<std::filesystem::path, std::string>>& named_contents);

/// The whole content of a file. Throws Error if it cannot be read.
std::string read_whole(const std::filesystem::path& file);

}  // namespace vernier::internal
