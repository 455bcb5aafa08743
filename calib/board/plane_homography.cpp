// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/plane_homography.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

#include "calib/base/decompositions.h"

namespace vernier::internal {
namespace {

/// Moves the mean to the origin and the mean distance from it to √2.
std::optional<Eigen::Matrix3d> normalisation(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double distance = 0;
  for (const auto& p : points) distance += (p - mean).norm();
  distance /= static_cast<double>(points.size());
  if (!(distance > 0)) return std::nullopt;
  const double s = std::sqrt(2.0) / distance;
  Eigen::Matrix3d N;
  N << s, 0, -s * mean.x(), 0, s, -s * mean.y(), 0, 0, 1;
  return N;
}

}  // namespace

std::optional<Eigen::Matrix3d> fit_homography(const std::vector<Eigen::Vector2d>& from,
                                              const std::vector<Eigen::Vector2d>& to) {
  if (from.size() < 4 || from.size() != to.size()) return std::nullopt;
  const auto N = normalisation(from), M = normalisation(to);
  if (!N || !M) return std::nullopt;
  Eigen::Matrix<double, 9, 9> A = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d x = *N * from[i].homogeneous();
    const Eigen::Vector2d u = map_point(*M, to[i]);
    Eigen::Matrix<double, 2, 9> rows = Eigen::Matrix<double, 2, 9>::Zero();
    rows.block<1, 3>(0, 0) = x.transpose();
    rows.block<1, 3>(1, 3) = x.transpose();
    rows.block<2, 3>(0, 6) = -u * x.transpose();
    A += rows.transpose() * rows;
  }
  const SymmetricEigen9 eigen(A);
  constexpr double min_second = 1e-6;  // of the largest: below, the points lie on a line
  if (eigen.eigenvalues[1] < min_second * eigen.eigenvalues[8]) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors.col(0);
  Eigen::Matrix3d H;
  H << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  return M->inverse() * H * *N;
}

Eigen::Matrix2d map_derivative(const Eigen::Matrix3d& H, const Eigen::Vector2d& x) {
  const Eigen::Vector3d q = H * x.homogeneous();
  const Eigen::Vector2d u = q.hnormalized();
  return (H.block<2, 2>(0, 0) - u * H.block<1, 2>(2, 0)) / q.z();
}

}  // namespace vernier::internal
