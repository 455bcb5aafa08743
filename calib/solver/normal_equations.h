// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"

namespace vernier::internal {

/// The normal equations of a board calibration with the board poses eliminated view by view
/// (Schur complement). With r the residuals of frame f divided by the pixel noise, A its
/// derivative by the rig's parameters and B by the frame's pose:
///
///     information  S = Σ_f AᵀA - AᵀB (BᵀB)⁻¹ BᵀA
///     score        g_f = Aᵀr - AᵀB (BᵀB)⁻¹ Bᵀr      (zero in sum at the optimum)
///
/// Everything is in the tangent of calib/rig.h. A board's warp is eliminated likewise, once, after
/// the frames.
struct ReducedNormalEquations {
  Eigen::MatrixXd information;          ///< S, parameters x parameters, prior included
  Eigen::VectorXd held_poses_diagonal;  ///< diagonal of Σ AᵀA: the information were poses known
  Eigen::MatrixXd scores;               ///< parameters x frames, one g_f a column
  std::vector<Eigen::MatrixXd> frame_information;  ///< each frame's term of S
  double chi2 = 0;                                 ///< Σ r²
  std::vector<double> frame_chi2;                  ///< one a frame
  int residuals = 0;                               ///< count of r
  Eigen::MatrixXd prior_information;               ///< the prior's term of S; empty without one
};

/// `pixel_sigma_px` is the standard deviation of a pixel coordinate.
ReducedNormalEquations reduced_normal_equations(const BoardObservations& observations,
                                                const BoardState& state,
                                                double pixel_sigma_px,
                                                BoardWarp warp = BoardWarp::known);

/// The same with the two unknowns of a free warp still there, last; of several sets of views of one
/// board these add up, and the warp is eliminated from their sum.
ReducedNormalEquations equations_with_warp(const BoardObservations& observations,
                                           const BoardState& state,
                                           double pixel_sigma_px);
/// Throws Error where the views say nothing about it.
ReducedNormalEquations without_warp(const ReducedNormalEquations& equations);

/// The equations of z where the parameters move by E z (calib/estimate/held_parameters.h).
ReducedNormalEquations restricted(const ReducedNormalEquations& equations,
                                  const Eigen::MatrixXd& E);

/// Adds a prior's information, in the same directions.
void add_prior(ReducedNormalEquations& equations, const Eigen::MatrixXd& information);

/// The same where a pixel's standard deviation is `pixel_sigma_ratio` times as large; `equations`
/// has no prior yet.
ReducedNormalEquations rescaled(ReducedNormalEquations equations, double pixel_sigma_ratio);

}  // namespace vernier::internal
