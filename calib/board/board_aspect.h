// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::internal {

/// Whether the board's aspect is estimated.
enum class BoardAspect { known, free };

/// The points of a board whose spacing along x and along y are not as 1 : 1 of the target's, as a
/// printer makes them:
///
///     x → x exp(a / 2),   y → y exp(−a / 2)
///
/// a, the aspect, is the logarithm of their ratio; their geometric mean stays, since views tell
/// nothing of the size of a board. Aspects add.
std::vector<Eigen::Vector3d> stretched_target(std::vector<Eigen::Vector3d> target_m, double aspect);

/// The derivative of the points with respect to the aspect, one column each (m).
Eigen::Matrix3Xd aspect_field(const std::vector<Eigen::Vector3d>& target_m);

}  // namespace vernier::internal
