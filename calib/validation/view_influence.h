// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/rig_estimate.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// The influence of the views of one frame on a calibration. With C = L Lᵀ the minimum variance
/// bound, S_f and g_f the frame's information and score (calib/solver/normal_equations.h) and H_f =
/// Lᵀ S_f L,
///
///     δ_f = C g_f                    the move of the estimate, to first order, were the frame's
///                                    score taken away; Σ_f δ_f = 0 without a prior
///     move without = L (I − H_f)⁻¹ Lᵀ g_f      its information taken away as well: the frame left
///                                    out, to first order (Cook 1977, for a group of residuals)
///
/// Lengths |L⁻¹ δ| are in standard deviations of the bound. For independent noise, E |L⁻¹ δ_f|² =
/// tr(H_f − H_f²): a frame far above that has an error of its own, such as a bent board, motion or
/// wrong corners.
struct ViewInfluence {
  int frame = 0;
  int corners = 0;
  double rms_px = 0;    ///< of the frame's residuals, per coordinate
  double leverage = 0;  ///< tr(C S_f); the sum is the number of parameters that the views determine
  double largest_share =
      0;  ///< largest eigenvalue of H_f: fraction of the information in one direction
  double influence = 0;                ///< |L⁻¹ δ_f|
  double expected_influence = 0;       ///< (tr(H_f − H_f²))^½, the rms for independent noise
  double leave_one_out_influence = 0;  ///< |L⁻¹ (move without)|; infinite if largest_share is 1
  Eigen::VectorXd delta;               ///< δ_f, in the tangent of calib/rig.h
  Eigen::VectorXd
      leave_one_out_delta;  ///< "move without"; empty if leave_one_out_influence is infinite
};

/// One per frame, in the equations' order, with `bound` their C (rows of held parameters zero),
/// without frame, corners and rms_px.
std::vector<ViewInfluence> view_influence(const ReducedNormalEquations& equations,
                                          const Eigen::MatrixXd& bound);

/// One per frame of the estimate's evidence. A board whose warp is not zero is assumed to have been
/// estimated with it. Throws Error(`place`) without evidence, pixel noise or the bound, and an
/// Error if a view is of a frame without a pose.
std::vector<ViewInfluence> view_influence(const RigEstimate& estimate,
                                          const std::string& place = "rig");

}  // namespace vernier::internal
