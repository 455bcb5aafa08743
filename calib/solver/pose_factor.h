// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>

namespace vernier::internal {

/// A pivot below this share of its diagonal is rounding: the corners do not fix the board's pose.
inline constexpr double min_pose_pivot = 1e-13;

/// Cholesky's factor of a frame's BᵀB, B the derivatives by the pose of its board. Throws
/// Error("frame 3") where its corners do not fix that pose.
Eigen::LLT<Eigen::Matrix<double, 6, 6>> pose_factor(const Eigen::Matrix<double, 6, 6>& BtB,
                                                    int frame);

}  // namespace vernier::internal
