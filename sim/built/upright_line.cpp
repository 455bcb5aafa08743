// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/built/upright_line.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "localise/joined_lines.h"
#include "sim/import/levelled.h"

namespace vernier::sim::internal {

using Eigen::Matrix2d;
using Eigen::Vector2d;

bool may_be_upright(const localise::JoinedLine& line, double most_rad) {
  const double beyond_three_sigma = 0.0027, rounding_m2 = 1e-12;
  const Vector2d offset = (line.b_m - line.a_m).head<2>();
  if (lean_rad(line.a_m, line.b_m) > most_rad) return false;
  const auto part = [&](int row, int column) {
    return Matrix2d(line.covariance_m2.block<2, 2>(row, column));
  };
  const Matrix2d S =
      part(0, 0) + part(3, 3) - part(0, 3) - part(3, 0) + rounding_m2 * Matrix2d::Identity();
  return offset.dot(S.ldlt().solve(offset)) <= -2 * std::log(beyond_three_sigma);
}

}  // namespace vernier::sim::internal
