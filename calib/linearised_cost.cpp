// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/linearised_cost.h"

#include "calib/error.h"
#include "calib/held_parameters.h"

namespace vernier {

LinearisedCost linearised_cost(const BoardObservations& observations,
                               const BoardState& state,
                               const ReprojectionProblem& problem) {
  check_problem(observations, state.rig, problem);
  std::vector<bool> held = problem.held;
  held.resize(static_cast<std::size_t>(parameter_count(state.rig)), false);
  LinearisedCost cost{free_directions(state.rig, held), free_names(state.rig, held), {}};
  if (cost.names.empty()) throw Error("calibration", "every parameter is held", "free one");
  cost.equations = restricted(
      reduced_normal_equations(observations, state, problem.pixel_sigma_px, problem.warp),
      cost.free);
  for (const RigPrior& prior : problem.priors) {
    const Eigen::MatrixXd J = prior_offset(prior, state.rig).by_rig * cost.free;
    add_prior(cost.equations, J.transpose() * prior.information * J);
  }
  return cost;
}

}  // namespace vernier
