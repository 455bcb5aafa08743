// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"

namespace vernier::stereo::internal {

/// A pixel, and what rounding to parts of one leaves.
inline constexpr float step_px = 1.01f;

/// The part of a disparity map within `half` pixels of a pixel; ends included.
struct MapWindow {
  const DisparityMap& map;
  int x0, y0, x1, y1;

  MapWindow(const DisparityMap& of, int x, int y, int half);

  /// Whether two known pixels adjacent along a row or column, or separated only by unknown ones,
  /// have disparities that differ by more than their distance.
  bool has_step() const;
};

/// The column nearest to where an edge crosses its row. Throws Error(place) for edges outside the
/// map.
int column_of(const EdgePoint& edge, const DisparityMap& map, const std::string& place);

/// Linear interpolation along row y between the two pixels beside x; the known one if only one is
/// known.
float along_row(const DisparityMap& map, float x, int y);

/// Throws Error(place) for a map without any known disparity.
void check_known(const DisparityMap& map, const std::string& place);

}  // namespace vernier::stereo::internal
