// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// Values over an image, as a picture.
struct HeatMap {
  std::string title, unit;
  std::vector<double> x_px, y_px;  ///< one a column, one a row
  std::vector<double> values;      ///< row by row; NaN is drawn grey
};

/// A self-contained SVG: cells coloured from the least to the greatest value (by their logarithms
/// where these are more than a factor of 4 apart), axes in pixels (v down, as the image), a colour
/// scale. Throws Error unless there is a value a cell and at least
/// two columns and rows.
std::string heat_map_svg(const HeatMap& map);

}  // namespace vernier::cli
