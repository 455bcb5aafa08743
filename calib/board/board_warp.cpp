// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/board_warp.h"

#include <cstddef>

namespace vernier::internal {

Eigen::Matrix<double, Eigen::Dynamic, 2> warp_shapes(const std::vector<Eigen::Vector3d>& target_m) {
  Eigen::Matrix<double, Eigen::Dynamic, 2> shapes(static_cast<Eigen::Index>(target_m.size()), 2);
  if (target_m.empty()) return shapes;
  Eigen::Vector3d low = target_m.front(), high = target_m.front();
  for (const Eigen::Vector3d& X : target_m) {
    low = low.cwiseMin(X);
    high = high.cwiseMax(X);
  }
  for (Eigen::Index i = 0; i < shapes.rows(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      const double extent = high[axis] - low[axis];
      const double x = extent > 0 ? 2 * (target_m[i][axis] - low[axis]) / extent - 1 : 0;
      shapes(i, axis) = 1 - x * x;
    }
  }
  return shapes;
}

std::vector<Eigen::Vector3d> warped_target(std::vector<Eigen::Vector3d> target_m,
                                           const Eigen::Vector2d& warp_m) {
  if (warp_m.isZero(0)) return target_m;
  const auto shapes = warp_shapes(target_m);
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    target_m[i].z() += shapes.row(static_cast<Eigen::Index>(i)).dot(warp_m);
  }
  return target_m;
}

}  // namespace vernier::internal
