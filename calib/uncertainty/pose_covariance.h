// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/estimate/stable_coordinates.h"
#include "calib/rig_and_boards.h"

namespace vernier::internal {

/// Covariance of (δ_a, m), parameters + 6: m = (w, u) is the mean motion of the boards, by which a
/// point x of the first camera's frame that is fixed to the boards moves as δx = w × x + u. The
/// mean over all frames of T_f′ T_f⁻¹ x has this form, since with the left tangents (ω_f, τ_f)
///
///     w = mean ω_f,   u = mean τ_f + t_f × ω_f.
///
/// So what mrcal propagates through the poses of all frames reduces to six numbers.
Eigen::MatrixXd rig_and_motion_covariance(const RigAndBoards& joint);

/// Covariance of (δ_a, δ_1, δ_2, …): the rig, then six per frame. For tests and export; large.
Eigen::MatrixXd rig_and_poses_covariance(const RigAndBoards& joint);

/// An affine map x′ = A x + b of the first camera's frame.
struct MeanBoardMap {
  Eigen::Matrix3d A;
  Eigen::Vector3d b;
};

/// One draw of the boards given that the rig deviates by `rig_deviation` and is `moved`: the mean
/// of T_f′ T_f⁻¹, not linearised. The boards turn with the rig's frame. The random streams are
/// those of (seed, trial), frame by frame.
MeanBoardMap sample_board_map(const RigAndBoards& joint,
                              const Eigen::VectorXd& rig_deviation,
                              const MovedRig& moved,
                              double psi_c,
                              std::uint64_t seed,
                              std::uint32_t trial);

}  // namespace vernier::internal
