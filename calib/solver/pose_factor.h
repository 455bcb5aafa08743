// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>

namespace vernier::internal {

/// A pivot below this fraction of its diagonal is rounding: the corners do not determine the pose.
inline constexpr double min_pose_pivot = 1e-13;

/// Cholesky factor of a frame's BᵀB, B the derivatives with respect to the pose of its board.
/// Throws Error("frame 3") if its corners do not determine that pose.
Eigen::LLT<Eigen::Matrix<double, 6, 6>> pose_factor(const Eigen::Matrix<double, 6, 6>& BtB,
                                                    int frame);

}  // namespace vernier::internal
