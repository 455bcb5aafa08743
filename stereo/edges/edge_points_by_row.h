// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

namespace vernier::stereo::internal {

/// Points of an image sorted by (y, x), at most one per pixel, and their support neighbours: the
/// nearest within reach along the row, up and down, and on both diagonals.
struct PointsByRow {
  std::vector<int> x, y;
  std::vector<int> row_begin;  ///< first index of every row, and the end

  /// Neighbours left, above, above left, above right; then right, below, below right, below left.
  /// −1: none within reach.
  std::vector<std::array<int, 8>> neighbours;

  int size() const { return static_cast<int>(x.size()); }
  double distance_px(int a, int b) const;
};

/// `x` and `y` have the same length and are sorted by (y, x).
PointsByRow points_by_row(std::vector<int> x, std::vector<int> y, int height_px);

}  // namespace vernier::stereo::internal
