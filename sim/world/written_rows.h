// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "sim/world.h"

namespace vernier::sim::internal {

/// The features of [loose] that stand in a world's text as format_world() writes them, one a line.
struct WrittenRows {
  FeatureSet features;
  std::string rest;  ///< the text without them, line by line where it was
};

/// Takes these features out of a text at once, which a TOML parser would do value by value: a
/// million segments in a second. Nothing is taken, and the parser reads all, where the text is
/// shorter than 1 MB, holds a string of several lines, or where a line is not exactly as it is
/// written: with a comment, or a number that is not plain.
std::optional<WrittenRows> take_written_rows(const std::string& text);

}  // namespace vernier::sim::internal
