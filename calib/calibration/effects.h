// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/rig_estimate.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// Throws Error for options that random effects leave no place for: a warp (a shape contains it), a
/// given pixel noise (it is one of the components), motion seen by one camera.
void check_effects(const CalibrationOptions& options, std::size_t cameras);

bool has_effects(const CalibrationOptions& options);

/// Moves state and linearised cost from the usual minimum to that with random effects
/// (calib/noise/random_effects.h), and adds the effects to the summary; a doubt if there is no such
/// minimum.
void move_to_effects(const CalibrationOptions& options,
                     const BoardObservations& observations,
                     const ReprojectionProblem& problem,
                     BoardState& state,
                     LinearisedCost& cost,
                     CalibrationSummary& summary);

}  // namespace vernier::internal
