// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/rig_estimate.h"

namespace vernier::internal {

/// One way in which a board may differ from its target: the displacements of the points in the
/// board's frame, one column each, by its unknown.
using BoardField = Eigen::Matrix3Xd;

/// Bends of a board, by metre: z = 1 − x², 1 − y² and x y with x and y in [−1, 1] over the target's
/// extent. The first two are its warp (calib/board/board_warp.h); with the third a cylinder may
/// have its axis in any direction.
std::vector<BoardField> bend_fields(const std::vector<Eigen::Vector3d>& target_m);

/// A test that a board is its target, against unknowns v of the board.
struct BoardTest {
  Eigen::VectorXd value;       ///< v, by generalised least squares
  Eigen::MatrixXd covariance;  ///< of v, by the components of the noise
  double chi2 = 0;             ///< vᵀ covariance⁻¹ v
  double p_value = 1;          ///< of as many degrees of freedom
};

/// Wald's test of unknowns of the board as fixed effects beside rig and poses, in the corner noise
/// V of calib/noise/corner_noise.h (white, smooth field, and motion where there are several
/// cameras), its components by the restricted likelihood with the unknowns in it:
///
///     v = −(S⁻¹ Σ A_fᵀ Q_f r_f)_v,   Var v = (S⁻¹)_vv
///
/// A part of the board that few views see has little to tell its variance from, as a random effect
/// has; a fixed effect needs none. `usual` is linearised at its rig and poses. Its p-values are a
/// little too small where they are off by several standard deviations, hence the level of 0.5 %
/// that calibrate() takes: of 400 sets of 4 to 7 views of a flat board it accused one (white noise;
/// docs/results.md). Throws Error if the corners do not determine the unknowns.
BoardTest board_test(const RigEstimate& usual, const std::vector<BoardField>& unknowns);

}  // namespace vernier::internal
