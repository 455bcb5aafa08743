// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board/board_aspect.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/rig_prior.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// The minimum of the unified cost with random effects.
struct EffectsMinimum {
  BoardState state;
  /// Of the board beyond its warp (state): x, y and z of every point; empty without.
  Eigen::VectorXd shape_m;
  double aspect = 0;                 ///< of the board beside that of the observations' target
  double aspect_sigma = 0;           ///< its standard deviation
  NoiseFit noise;                    ///< at it
  Eigen::MatrixXd free;              ///< free directions of the rig, parameters x free
  ReducedNormalEquations equations;  ///< of these, shape eliminated; its prior is in theirs
  bool converged = false;
};

/// Minimises over the rig a, a pose b_f in each frame, the board's warp (calib/board/board_warp.h;
/// with a shape, and without a prior) and shape s, and a twist u_f of the
/// board between the exposures of each frame
///
///     Σ_f |r_f(a, b_f, s, u_f)|²_{(w² I + g² K)⁻¹} + Σ_f (|u_rot|² / s_r² + |u_trans|² / s_t²)
///     + Σ_i (s_x² + s_y²) / b² + s_z² / h² + priors of the rig
///
/// with the components of calib/noise/corner_noise.h by restricted likelihood, from the minimum
/// `start` of the usual cost, by Gauss–Newton steps. The twists are eliminated as the poses are,
/// which gives V_f its term M_f S M_fᵀ (Henderson's mixed model equations and generalised least
/// squares are the same: Robinson 1991). The components are found again at the minimum. `held`: one
/// flag per parameter of the rig; empty: none. A free aspect of the board
/// (calib/board/board_aspect.h) is one more unknown, without a prior.
EffectsMinimum minimise_with_effects(const BoardObservations& observations,
                                     const BoardState& start,
                                     const std::vector<bool>& held,
                                     const std::vector<RigPrior>& priors,
                                     NoiseParts parts,
                                     BoardAspect aspect = BoardAspect::known);

}  // namespace vernier::internal
