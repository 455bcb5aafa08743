// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"

namespace vernier::internal {

/// A minimum of the reprojection error to rounding.
struct RefinedMinimum {
  BoardState state;
  Eigen::MatrixXd unit_bound;  ///< minimum variance bound at a noise of 1 px, of all parameters
  Eigen::MatrixXd
      free_bound;           ///< the same of the free directions (calib/estimate/held_parameters.h)
  double cost_px2 = 0;      ///< Σ r²
  double last_step_px = 0;  ///< length of the last step in standard deviations, times σ in px
  bool converged = false;   ///< else the state is the start, and the bound is there
};

/// Takes a state near the minimum to it by Gauss and Newton's steps, which need no look at the
/// cost: at a distance of d standard deviations the cost differs by d² σ², so a solver that
/// compares costs in double precision stops at d about 1e-6. Steps and bound come from
/// calib/solver/square_root_system.h, so they keep their digits where the parameters hardly differ
/// in their effect (opencv8). `held` has one entry a parameter; empty holds none. The board keeps
/// the warp it has.
RefinedMinimum refine_minimum(const BoardObservations& observations,
                              const BoardState& start,
                              std::vector<bool> held = {});

}  // namespace vernier::internal
