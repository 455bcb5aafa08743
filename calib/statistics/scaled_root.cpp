// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/scaled_root.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "calib/base/decompositions.h"

namespace vernier::internal {
namespace {

Eigen::VectorXd inverse_or_zero(const Eigen::VectorXd& deviations) {
  return deviations.unaryExpr([](double d) { return d > 0 ? 1 / d : 0.0; });
}

}  // namespace

ScaledEigen::ScaledEigen(const Eigen::MatrixXd& matrix)
    : deviations(matrix.diagonal().cwiseMax(0).cwiseSqrt()) {
  const Eigen::VectorXd inverse = inverse_or_zero(deviations);
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * matrix * inverse.asDiagonal();
  const SymmetricEigen eigen(0.5 * (scaled + scaled.transpose()));
  std::vector<Eigen::Index> order(static_cast<std::size_t>(matrix.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return eigen.eigenvalues()[a] > eigen.eigenvalues()[b];
  });
  values = eigen.eigenvalues()(order);
  directions = eigen.eigenvectors()(Eigen::all, order);
}

ScaledRoot::ScaledRoot(const Eigen::MatrixXd& matrix) {
  const ScaledEigen eigen(matrix);
  const Eigen::VectorXd& s = eigen.values;
  const auto q = s.size() == 0 ? 0 : (s.array() > 1e-12 * s[0]).count();
  const Eigen::MatrixXd U = eigen.directions.leftCols(q);
  const Eigen::VectorXd half = s.head(q).cwiseSqrt();
  root = eigen.deviations.asDiagonal() * U * half.asDiagonal();
  white = half.cwiseInverse().asDiagonal() * U.transpose() *
          inverse_or_zero(eigen.deviations).asDiagonal();
}

}  // namespace vernier::internal
