// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::internal {

/// Out-of-plane shape of a slightly bent board as two parabolas (the model of calobject_warp in
/// mrcal 2.2):
///
///     z(x, y) = warp_x (1 - x²) + warp_y (1 - y²),   x, y in [-1, 1] over the target's extent
///
/// Returns one row per target point: the derivatives of z with respect to (warp_x, warp_y),
/// dimensionless.
Eigen::Matrix<double, Eigen::Dynamic, 2> warp_shapes(const std::vector<Eigen::Vector3d>& target_m);

/// The target's points with the warp (metres) added to z.
std::vector<Eigen::Vector3d> warped_target(std::vector<Eigen::Vector3d> target_m,
                                           const Eigen::Vector2d& warp_m);

}  // namespace vernier::internal
