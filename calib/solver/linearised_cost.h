// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// The unified cost linearised at a state, in the free directions:
///
///     a = a_state ⊕ E z,   χ²(z) ≈ χ² + 2 gᵀ z + zᵀ S z
///
/// board poses and a free warp eliminated, priors included.
struct LinearisedCost {
  Eigen::MatrixXd free;              ///< E (calib/estimate/held_parameters.h)
  std::vector<std::string> names;    ///< of the free directions, one per column of E
  ReducedNormalEquations equations;  ///< of z, at the problem's noise
};

/// That of a prior at `rig`, in the directions E.
Eigen::MatrixXd prior_information(const RigPrior& prior, const Rig& rig, const Eigen::MatrixXd& E);

/// Adds the information of the priors at `rig`, in the directions E.
void add_priors(ReducedNormalEquations& equations,
                const std::vector<RigPrior>& priors,
                const Rig& rig,
                const Eigen::MatrixXd& E);

/// Corner weights and matched pairs are ignored. Throws Error if every parameter is held, or like
/// check_problem and reduced_normal_equations. Use minimum_variance_bound(equations, names) to
/// check that z is determined.
LinearisedCost linearised_cost(const BoardObservations& observations,
                               const BoardState& state,
                               const ReprojectionProblem& problem);

}  // namespace vernier::internal
