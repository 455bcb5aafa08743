// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/calibrate.h"
#include "calib/rig.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// The cost described by these options for a rig like `rig`: held parameters, priors, warp. Its
/// noise is that of the options, or 1 px if it is to be estimated. Throws Error for a held or known
/// parameter that the rig does not have.
ReprojectionProblem problem_of(const CalibrationOptions& options, const Rig& rig);

/// Throws Error for noise that is negative or not finite, and for no iterations.
void check_numbers(const CalibrationOptions& options);

}  // namespace vernier::internal
