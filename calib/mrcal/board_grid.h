// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::internal {

/// A target as mrcal has it: the points (column, row, 0) · spacing of a full rectangular grid.
struct BoardGrid {
  int columns = 0, rows = 0;
  double spacing_m = 0;
  Eigen::Vector3d origin_m{0, 0, 0};  ///< where the target has the grid's first point
  std::vector<int> cell;              ///< row · columns + column, one a target point

  int points() const { return columns * rows; }
};

/// The grid that the target's points lie on; cells without a point are allowed
/// (up to three of four). Throws Error where
/// the points are not on a flat, square grid along the target's axes, at least 2 x 2.
BoardGrid board_grid(const std::vector<Eigen::Vector3d>& target_m);

}  // namespace vernier::internal
