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
/// over the rig, one pose of the board a frame and, if free, the board's warp, by Ceres (dense
/// Schur, one analytic block a view). r is the reprojection residual of the board's corners and
/// the Sampson residual of matched pairs (calib/solver/epipolar_formulas.inc), which have σ of
/// their own; either may be absent. Returns the state at the minimum; throws Error where Ceres
/// finds none, as above, and for a camera without views or pairs unless each of its parameters is
/// held or known by a prior. Whether the views determine the rig is not asked
/// (calib/solver/linearised_cost.h).
///
/// Ceres warns of a linear solver's failure through glog, whatever its options; that is no fault of
/// the result. glog's threshold is one for the whole process and not to be changed while others
/// log, so this function leaves it alone. A program that wants silence sets FLAGS_minloglevel =
/// google::GLOG_FATAL before its threads start, as vernier does.
BoardState minimise_reprojection(const BoardObservations& observations,
                                 BoardState start,
                                 const ReprojectionProblem& problem = {});

}  // namespace vernier::internal
