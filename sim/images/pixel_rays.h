// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/camera.h"

namespace vernier::sim::internal {

/// Rays (x / z, y / z) of a row of pixels, in the camera's frame: exact at the corners of pixels,
/// bilinear between. NaN where the lens model has none.
class RowRays {
 public:
  RowRays(const Camera& camera, int row);

  /// At (x + dx - 0.5, row + dy - 0.5), dx and dy in [0, 1].
  Eigen::Vector2d at(int x, double dx, double dy) const {
    const auto i = static_cast<std::size_t>(x);
    return (1 - dy) * ((1 - dx) * above_[i] + dx * above_[i + 1]) +
           dy * ((1 - dx) * below_[i] + dx * below_[i + 1]);
  }

 private:
  std::vector<Eigen::Vector2d> above_, below_;
};

/// Places of n² samples in a pixel, in [0, 1]²: cell (i, j) has
///
///     x = (i + (j + 1/2) / n) / n,   y = (j + (i + 1/2) / n) / n
std::vector<Eigen::Vector2d> sample_places(int n);

}  // namespace vernier::sim::internal
