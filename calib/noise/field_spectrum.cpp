// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/field_spectrum.h"

#include <cstddef>

namespace vernier::internal {

Eigen::MatrixXd squared_distances(const std::vector<Eigen::Vector3d>& points_m) {
  const auto n = static_cast<Eigen::Index>(points_m.size());
  Eigen::MatrixXd d2(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      d2(i, j) = (points_m[static_cast<std::size_t>(i)] - points_m[static_cast<std::size_t>(j)])
                     .squaredNorm();
    }
  }
  return d2;
}

Eigen::MatrixXd field_correlation(const std::vector<Eigen::Vector3d>& points_m, double length_m) {
  return (squared_distances(points_m).array() / (-2 * length_m * length_m)).exp();
}

}  // namespace vernier::internal
