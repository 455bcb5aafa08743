// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sim/world.h"

namespace vernier::sim {

/// Reads a .world.toml (format "vernier/world", version 1; see docs/file-formats.md). Throws Error
/// with file, line and key for anything malformed: TOML syntax, an unknown key, a wrong type, a
/// segment that is not six numbers, a zero-length segment, an unknown template.
WorldDescription read_world(const std::filesystem::path& file);

/// The same text from memory; `place` stands for the file in messages.
WorldDescription parse_world(const std::string& text, const std::string& place);

/// The text of a .world.toml. Lengths with a tenth of a millimetre, so that the same description
/// always gives the same bytes, and reading it back gives the same text again.
std::string format_world(const WorldDescription& description);

/// Writes that text; the file appears whole, by rename, or not at all.
void write_world(const WorldDescription& description, const std::filesystem::path& file);

}  // namespace vernier::sim
