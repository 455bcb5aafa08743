// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/initial_rig.h"

namespace vernier {

/// The normal equations of a board calibration with the board poses eliminated view by view
/// (Schur complement). With r the residuals of frame f divided by the pixel noise, A its
/// derivative by the rig's parameters and B by the frame's pose:
///
///     information  S = Σ_f AᵀA - AᵀB (BᵀB)⁻¹ BᵀA
///     score        g_f = Aᵀr - AᵀB (BᵀB)⁻¹ Bᵀr      (zero in sum at the optimum)
///
/// Everything is in the tangent of calib/rig.h.
struct ReducedNormalEquations {
  Eigen::MatrixXd information;          ///< S, parameters x parameters
  Eigen::VectorXd held_poses_diagonal;  ///< diagonal of Σ AᵀA: the information were poses known
  Eigen::MatrixXd scores;               ///< parameters x frames, one g_f a column
  std::vector<Eigen::MatrixXd> frame_information;  ///< each frame's term of S
  double chi2 = 0;                                 ///< Σ r²
  std::vector<double> frame_chi2;                  ///< one a frame
  int residuals = 0;                               ///< count of r
};

/// `pixel_sigma_px` is the standard deviation of a pixel coordinate.
ReducedNormalEquations reduced_normal_equations(const BoardObservations& observations,
                                                const BoardState& state,
                                                double pixel_sigma_px);

}  // namespace vernier
