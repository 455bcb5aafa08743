// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/initial_rig.h"

namespace vernier {

/// A minimum of the reprojection error to rounding.
struct RefinedMinimum {
  BoardState state;
  Eigen::MatrixXd unit_bound;  ///< minimum variance bound at a noise of 1 px; zero where held
  double cost_px2 = 0;         ///< Σ r²
  double last_step_px = 0;     ///< length of the last step in standard deviations, times σ in px
  bool converged = false;      ///< whether rounding and nothing else ends the steps
};

/// Takes a state near the minimum to it by Gauss and Newton's steps, which need no look at the
/// cost: at a distance of d standard deviations the cost differs by d² σ², so a solver that
/// compares costs in double precision stops at d about 1e-6. Steps and bound come from
/// calib/square_root_system.h, so they keep their digits where the parameters hardly differ in
/// their effect (opencv8). `held` has one entry a parameter; empty holds none. The board keeps the
/// warp it has. Throws Error where the observations leave a direction free.
RefinedMinimum refine_minimum(const BoardObservations& observations,
                              BoardState state,
                              const std::vector<bool>& held = {});

}  // namespace vernier
