// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"

namespace vernier::internal {

/// The normal equations of a board calibration with the board poses eliminated frame by frame
/// (Schur complement). With r the residuals of frame f divided by the pixel noise, A their
/// derivative with respect to the rig's parameters and B with respect to the frame's pose:
///
///     information  S = Σ_f AᵀA - AᵀB (BᵀB)⁻¹ BᵀA
///     score        g_f = Aᵀr - AᵀB (BᵀB)⁻¹ Bᵀr      (zero in sum at the optimum)
///
/// Everything is in the tangent of calib/rig.h. A free warp is eliminated in the same way, once,
/// after the frames.
struct ReducedNormalEquations {
  Eigen::MatrixXd information;          ///< S, parameters x parameters, prior included
  Eigen::VectorXd held_poses_diagonal;  ///< diagonal of Σ AᵀA: the information with known poses
  Eigen::MatrixXd scores;               ///< parameters x frames, one g_f per column
  std::vector<Eigen::MatrixXd> frame_information;  ///< each frame's term of S
  double chi2 = 0;                                 ///< Σ r²
  std::vector<double> frame_chi2;                  ///< one per frame
  int residuals = 0;                               ///< count of r
  Eigen::MatrixXd prior_information;               ///< the prior's term of S; empty without one
};

/// `pixel_sigma_px` is the standard deviation of a pixel coordinate.
ReducedNormalEquations reduced_normal_equations(const BoardObservations& observations,
                                                const BoardState& state,
                                                double pixel_sigma_px,
                                                BoardWarp warp = BoardWarp::known);

/// The same with the two unknowns of a free warp, which come last. For several sets of views of one
/// board these are added, and the warp is eliminated from their sum.
ReducedNormalEquations equations_with_warp(const BoardObservations& observations,
                                           const BoardState& state,
                                           double pixel_sigma_px);
/// Throws Error if the views do not constrain the warp.
ReducedNormalEquations without_warp(const ReducedNormalEquations& equations);

/// The equations in z if the parameters move by E z (calib/estimate/held_parameters.h).
ReducedNormalEquations restricted(const ReducedNormalEquations& equations,
                                  const Eigen::MatrixXd& E);

/// Adds a prior's information, in the same directions.
void add_prior(ReducedNormalEquations& equations, const Eigen::MatrixXd& information);

/// The same with a pixel's standard deviation multiplied by `pixel_sigma_ratio`; `equations` must
/// not contain a prior.
ReducedNormalEquations rescaled(ReducedNormalEquations equations, double pixel_sigma_ratio);

}  // namespace vernier::internal
