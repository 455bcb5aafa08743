// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// The distribution of the board poses given the rig.
///
/// reduced_normal_equations (calib/solver/normal_equations.h) eliminates the board poses; this
/// keeps what is needed to recover them. With A, B, W the derivatives of a frame's residuals with
/// respect to the rig a, the board's pose in that frame and the board's warp w, the minimum moves,
/// at unit noise,
///
///     δ_f = −(BᵀB)⁻¹ (BᵀA δ_a + BᵀW δ_w) + ε_f,   Cov ε_f = (BᵀB)⁻¹
///     δ_w = −S_ww⁻¹ S_wa δ_a + ε_w,               Cov ε_w = S_ww⁻¹
///
/// with S the information after elimination of the poses, and ε_f, ε_w and δ_a independent of each
/// other. This is the inverse of the full normal matrix written as a chain: joint covariances of
/// rig and boards follow without forming it, for any covariance of a. Tangents: calib/rig.h for a,
/// calib/pose.h for δ_f.
struct ConditionalBoardPoses {
  struct Frame {
    Eigen::Matrix<double, 6, Eigen::Dynamic> by_rig;  ///< −(BᵀB)⁻¹ BᵀA, 6 x parameters
    Eigen::Matrix<double, 6, 2> by_warp;              ///< −(BᵀB)⁻¹ BᵀW, a metre of warp
    Eigen::Matrix<double, 6, 6> factor;               ///< of Cov ε_f at a noise of 1 px
  };
  std::vector<Frame> frames;
  Eigen::Matrix<double, 2, Eigen::Dynamic> warp_by_rig;  ///< −S_ww⁻¹ S_wa
  Eigen::Matrix2d warp_factor;                           ///< of Cov ε_w; zero for a flat board
};

/// Linearised at `state`. The warp counts as estimated if it is not zero, as fixed for a flat
/// board. Throws Error if the corners of a frame do not determine the pose of its board.
ConditionalBoardPoses conditional_board_poses(const BoardObservations& observations,
                                              const BoardState& state);

/// The same of a calibration with random effects: everything above weighted by V_f⁻¹
/// (calib/noise/corner_noise.h) at the shape that was found, with V_f in units of pixel_sigma_px².
/// The warp counts as estimated if there is a shape; of the rest of the shape, which its prior
/// keeps small, the error is left out.
ConditionalBoardPoses conditional_board_poses(const BoardObservations& observations,
                                              const BoardState& state,
                                              const CalibrationEffects& effects,
                                              double pixel_sigma_px);

}  // namespace vernier::internal
