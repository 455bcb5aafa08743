// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/reprojection_problem.h"

#include <cstddef>

#include "calib/board_observations.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

void check_problem(const BoardObservations& observations,
                   const Rig& rig,
                   const ReprojectionProblem& problem) {
  const int n = parameter_count(rig);
  if (!problem.held.empty() && static_cast<int>(problem.held.size()) != n) {
    throw Error("held parameters", "there is not one flag per rig parameter",
                "make them with held_mask");
  }
  for (const RigPrior& prior : problem.priors) {
    if (prior.information.rows() != n || prior.information.cols() != n ||
        parameter_names(prior.mean) != parameter_names(rig)) {
      throw Error("prior", "it does not match the rig's parameters", "make it with rig_prior");
    }
  }
  bool fits =
      problem.corner_weights.empty() || problem.corner_weights.size() == observations.views.size();
  for (std::size_t v = 0; fits && v < problem.corner_weights.size(); ++v) {
    fits = problem.corner_weights[v].size() == observations.views[v].ids.size();
  }
  if (!fits) throw Error("corner weights", "there is not one per corner", "give one per corner");
  if (!(problem.pixel_sigma_px > 0)) {
    throw Error("pixel sigma", "it is not positive", "give a standard deviation in pixels");
  }
}

}  // namespace vernier::internal
