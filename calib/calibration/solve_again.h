// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/calibrate.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// The options that `estimate` was calibrated with, as far as it holds them: models, fixed
/// parameters, free warp, random effects, and whether the noise was estimated. Outliers are already
/// removed. `estimate` must have a calibration and evidence.
CalibrationOptions options_to_solve_again(const RigEstimate& estimate);

/// The same with calibrate()'s default camera names: left, right, camera2 … Use it for the options
/// passed to calibrate(), whose parameter names contain them.
RigEstimate with_default_names(RigEstimate estimate);

/// The calibration of the same corners without random effects, for what knows none, and with the
/// board's aspect known; `estimate`
/// itself if it has none, or no views of a board. Throws what calibrate() throws.
RigEstimate without_effects(const RigEstimate& estimate);

}  // namespace vernier::internal
