// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/field_spectrum.h"

#include <cmath>
#include <cstddef>

#include "calib/base/decompositions.h"

namespace vernier::internal {
namespace {

/// |X_i − X_j|² / ℓ²
Eigen::MatrixXd squared_distances(const std::vector<Eigen::Vector3d>& points_m, double length_m) {
  const auto n = static_cast<Eigen::Index>(points_m.size());
  Eigen::MatrixXd d2(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      d2(i, j) = ((points_m[static_cast<std::size_t>(i)] - points_m[static_cast<std::size_t>(j)]) /
                  length_m)
                     .squaredNorm();
    }
  }
  return d2;
}

}  // namespace

Eigen::MatrixXd field_correlation(const std::vector<Eigen::Vector3d>& points_m, double length_m) {
  return (-0.5 * squared_distances(points_m, length_m).array()).exp();
}

FieldSpectrum field_spectrum(const std::vector<Eigen::Vector3d>& points_m, double length_m) {
  const Eigen::MatrixXd d2 = squared_distances(points_m, length_m);
  const Eigen::MatrixXd K = (-0.5 * d2.array()).exp();
  const SymmetricEigen eigen(K);
  const Eigen::MatrixXd& U = eigen.eigenvectors();
  return {U, eigen.eigenvalues().cwiseMax(0.0), U.transpose() * K.cwiseProduct(d2) * U};
}

}  // namespace vernier::internal
