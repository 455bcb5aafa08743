// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sim/world.h"

namespace vernier::sim {

/// Reads a .world.toml (format "vernier/world", version 1; see docs/file-formats.md). Throws Error
/// with file, line and key for malformed input: TOML syntax, an unknown key, a wrong type, a
/// segment that is not six numbers, a zero-length segment, an unknown template.
WorldDescription read_world(const std::filesystem::path& file);

/// The same from text in memory; `place` stands for the file name in messages.
WorldDescription parse_world(const std::string& text, const std::string& place);

/// The text of a .world.toml. Lengths are written to a tenth of a millimetre, so that the same
/// description always gives the same bytes, and reading and writing them again gives the same text.
std::string format_world(const WorldDescription& description);

/// Writes that text atomically: to a temporary file that is then renamed.
void write_world(const WorldDescription& description, const std::filesystem::path& file);

}  // namespace vernier::sim
