// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::internal {

/// A target in mrcal's form: the points (column, row, 0) · spacing of a full rectangular grid.
struct BoardGrid {
  int columns = 0, rows = 0;
  double spacing_m = 0;
  Eigen::Vector3d origin_m{0, 0, 0};  ///< position of the grid's first point in the target
  std::vector<int> cell;              ///< row · columns + column, one per target point

  int points() const { return columns * rows; }
};

/// The grid that the target's points lie on; up to three of four cells may be empty. Throws Error
/// if the points are not on a flat, square grid along the target's axes, at least 2 x 2.
BoardGrid board_grid(const std::vector<Eigen::Vector3d>& target_m);

}  // namespace vernier::internal
