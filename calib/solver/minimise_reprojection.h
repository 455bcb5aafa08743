// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// Minimises the unified cost
///
///     χ²(a) = Σ priors + Σ_i w_i |r_i(a)|² / σ²
///
/// over the rig, one board pose per frame and, if free, the board's warp, by Ceres (dense Schur,
/// one analytic block per view). r is the reprojection residual of the board's corners and the
/// Sampson residual of matched pairs (calib/solver/epipolar_formulas.inc), which have their own σ;
/// either may be absent. Returns the state at the minimum. Throws Error if Ceres finds none, and
/// for a camera without views or pairs unless all its parameters are held or have a prior. Does not
/// check that the views determine the rig (calib/solver/linearised_cost.h).
///
/// Ceres logs a warning through glog if a linear solve fails, whatever its options; the result is
/// not affected. glog's threshold is global to the process and must not be changed while other
/// threads log, so this function does not touch it. To silence it, a program sets FLAGS_minloglevel
/// = google::GLOG_FATAL before it starts threads, as vernier does.
BoardState minimise_reprojection(const BoardObservations& observations,
                                 const BoardState& start,
                                 const ReprojectionProblem& problem = {});

}  // namespace vernier::internal
