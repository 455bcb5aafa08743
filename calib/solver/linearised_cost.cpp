// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/linearised_cost.h"

#include <cstddef>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

Eigen::MatrixXd prior_information(const RigPrior& prior, const Rig& rig, const Eigen::MatrixXd& E) {
  const Eigen::MatrixXd J = prior_offset(prior, rig).by_rig * E;
  return J.transpose() * prior.information * J;
}

void add_priors(ReducedNormalEquations& equations,
                const std::vector<RigPrior>& priors,
                const Rig& rig,
                const Eigen::MatrixXd& E) {
  for (const RigPrior& prior : priors) add_prior(equations, prior_information(prior, rig, E));
}

LinearisedCost linearised_cost(const BoardObservations& observations,
                               const BoardState& state,
                               const ReprojectionProblem& problem) {
  check_problem(observations, state.rig, problem);
  std::vector<bool> held = problem.held;
  held.resize(static_cast<std::size_t>(parameter_count(state.rig)), false);
  LinearisedCost cost{free_directions(state.rig, held), free_names(state.rig, held), {}};
  if (cost.names.empty())
    throw Error("calibration", "every parameter is fixed", "free at least one");
  cost.equations = restricted(
      reduced_normal_equations(observations, state, problem.pixel_sigma_px, problem.warp),
      cost.free);
  add_priors(cost.equations, problem.priors, state.rig, cost.free);
  return cost;
}

}  // namespace vernier::internal
