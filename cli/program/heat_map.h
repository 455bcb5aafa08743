// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// A heat map over an image.
struct HeatMap {
  std::string title, unit;
  std::vector<double> x_px, y_px;  ///< one per column, one per row
  std::vector<double> values;      ///< row by row; NaN is drawn grey
};

/// A self-contained SVG: cells coloured from the smallest to the largest value (logarithmically if
/// they differ by more than a factor of 4), axes in pixels (v down, as in the image) and a colour
/// bar. Throws Error unless there is one value per cell and at least two columns and rows.
std::string heat_map_svg(const HeatMap& map);

}  // namespace vernier::cli
