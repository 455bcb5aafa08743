// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier {

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

/// Joint distribution of rig and boards, needed for points fixed in space rather than in a camera
/// (mrcal's reference for its projection uncertainty).
///
/// The covariance of the boards given the rig is board_sigma_px² times that of joint_information.h.
/// For the bound, board_sigma_px is the pixel noise σ and everything is (JᵀJ)⁻¹ σ² exactly. For the
/// honest covariance C of the rig it is σ √φ with the mean inflation of the part determined by the
/// views,
///
///     φ = (tr(C_bound⁻¹ C) − (p − d)) / d,   d = tr(C_bound S)
///
/// for p parameters, S the views' information: the prior's part, p − d, is not inflated. The
/// residuals of a frame cannot show the error of its own pose (Bᵀr = 0 at the minimum for any
/// noise), so no sandwich covers that part; it is assumed to be inflated like the rig.
struct RigAndBoards {
  Rig rig;
  std::vector<int> frames;          ///< ascending
  std::vector<Pose> T_first_board;  ///< one per frame
  Eigen::MatrixXd rig_covariance;
  ConditionalBoardPoses given_rig;
  double board_sigma_px = 0;
};

/// Throws Error(`place`) if the estimate has no evidence, pixel noise or covariance.
RigAndBoards rig_and_boards(const RigEstimate& estimate,
                            CovarianceChoice choice,
                            const std::string& place = "rig");

}  // namespace vernier
