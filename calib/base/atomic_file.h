// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vernier::internal {

/// Writes `content` to `file` atomically: an interrupted run leaves the old file unchanged. Throws
/// Error if it cannot be written. For large files, piece by piece: file_in_progress.h.
void write_atomically(const std::filesystem::path& file, std::string_view content);

/// The same for several files, each a name and its content, all or none. With folders to make, or
/// piece by piece: output_files.h.
void write_atomically(
    const std::vector<std::pair<std::filesystem::path, std::string>>& named_contents);

/// Larger files than this are no input of the program: 1 GiB.
inline constexpr std::size_t most_file_bytes = std::size_t{1} << 30;

/// The whole content of a regular file, or of a pipe until its end. Throws Error for anything else,
/// such as a device, and for one that cannot be read or is larger than `most_bytes`. A pipe is read
/// once; until it is written again the next calls return what it held.
std::string read_whole(const std::filesystem::path& file, std::size_t most_bytes = most_file_bytes);

}  // namespace vernier::internal
