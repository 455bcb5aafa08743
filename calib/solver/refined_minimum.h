// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"

namespace vernier::internal {

/// A minimum of the reprojection error up to rounding.
struct RefinedMinimum {
  BoardState state;
  Eigen::MatrixXd unit_bound;  ///< minimum variance bound at a noise of 1 px, of all parameters
  /// The same for the free directions (calib/estimate/held_parameters.h).
  Eigen::MatrixXd free_bound;
  double cost_px2 = 0;      ///< Σ r²
  double last_step_px = 0;  ///< length of the last step in standard deviations, times σ in px
  bool converged = false;   ///< if not, the state is the start, with the bound there
};

/// Refines a state near the minimum by Gauss–Newton steps without comparing costs: at a distance of
/// d standard deviations the cost differs by d² σ², so a solver that compares costs in double
/// precision stops at d about 1e-6. Steps and bound come from calib/solver/square_root_system.h, so
/// they stay accurate if the effects of the parameters hardly differ (opencv8). `held` has one
/// entry per parameter; empty: none held. The board's warp is kept.
RefinedMinimum refine_minimum(const BoardObservations& observations,
                              const BoardState& start,
                              std::vector<bool> held = {});

}  // namespace vernier::internal
