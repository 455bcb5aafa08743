// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier {

namespace internal {
struct ConditionalBoardPoses;
}  // namespace internal

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
/// noise), so no sandwich covers that part; it is assumed to be inflated like the rig. With random
/// effects all of this is weighted by them.
struct RigAndBoards {
  Rig rig;
  std::vector<int> frames;          ///< ascending
  std::vector<Pose> T_first_board;  ///< one per frame
  Eigen::MatrixXd rig_covariance;
  std::shared_ptr<const vernier::internal::ConditionalBoardPoses> given_rig;
  double board_sigma_px = 0;
};

/// Throws Error(`place`) if the estimate has no evidence, pixel noise or covariance.
RigAndBoards rig_and_boards(const RigEstimate& estimate,
                            CovarianceChoice choice,
                            const std::string& place = "rig");

}  // namespace vernier
