// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

namespace vernier::stereo::internal {

/// Points of an image in the order of (y, x), at most one a pixel, and which of them support each
/// other: along the row, up and down, and on both diagonals, to the nearest in reach.
struct PointsByRow {
  std::vector<int> x, y;
  std::vector<int> row_begin;  ///< of every row and the end

  /// Neighbours left, above, above left, above right; then right, below, below right, below left.
  /// −1 where there is none in reach.
  std::vector<std::array<int, 8>> neighbours;

  int size() const { return static_cast<int>(x.size()); }
  double distance_px(int a, int b) const;
};

/// `x` and `y` are of the same length and in order.
PointsByRow points_by_row(std::vector<int> x, std::vector<int> y, int height_px);

}  // namespace vernier::stereo::internal
