// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// As parse_grid, with no more cells (or corners of a board) than `most_cells`.
std::pair<int, int> parse_limited_grid(const std::string& text,
                                       const std::string& option,
                                       int most_cells);

/// As parse_limited_grid, for points of an image from one edge to the other: at least 2x2.
std::pair<int, int> parse_image_grid(const std::string& text,
                                     const std::string& option,
                                     int most_cells);

}  // namespace vernier::cli
