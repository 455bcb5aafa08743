// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/calibrate.h"
#include "calib/rig.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// The cost that these options describe for a rig like `rig`: held parameters, priors, warp. Its
/// noise is that of the options, 1 px where they leave it to the residuals. Throws Error where a
/// held or known parameter is none of the rig's.
ReprojectionProblem problem_of(const CalibrationOptions& options, const Rig& rig);

}  // namespace vernier::internal
