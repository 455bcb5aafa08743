// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/board_aspect.h"

#include <cmath>
#include <cstddef>

namespace vernier::internal {

std::vector<Eigen::Vector3d> stretched_target(std::vector<Eigen::Vector3d> target_m,
                                              double aspect) {
  if (aspect == 0) return target_m;
  const Eigen::Vector3d scale(std::exp(0.5 * aspect), std::exp(-0.5 * aspect), 1);
  for (Eigen::Vector3d& X : target_m) X = X.cwiseProduct(scale);
  return target_m;
}

Eigen::Matrix3Xd aspect_field(const std::vector<Eigen::Vector3d>& target_m) {
  Eigen::Matrix3Xd field(3, static_cast<Eigen::Index>(target_m.size()));
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    field.col(static_cast<Eigen::Index>(i)) =
        target_m[i].cwiseProduct(Eigen::Vector3d(0.5, -0.5, 0));
  }
  return field;
}

}  // namespace vernier::internal
