// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace vernier::internal {

/// The homography from points of a plane to pixels, by the normalised direct linear transform
/// (Hartley 1997). std::nullopt for fewer than four points or a degenerate configuration.
std::optional<Eigen::Matrix3d> fit_homography(const std::vector<Eigen::Vector2d>& from,
                                              const std::vector<Eigen::Vector2d>& to);

inline Eigen::Vector2d map_point(const Eigen::Matrix3d& H, const Eigen::Vector2d& x) {
  return (H * x.homogeneous()).hnormalized();
}

/// The derivative of map_point with respect to the point.
Eigen::Matrix2d map_derivative(const Eigen::Matrix3d& H, const Eigen::Vector2d& x);

}  // namespace vernier::internal
