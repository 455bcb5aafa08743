// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/calibrate.h"
#include "calib/rig_estimate.h"
#include "cli/calibration/check_section.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// The options that `estimate` was calibrated with, as far as the file contains them: models, fixed
/// parameters, free warp, and whether the noise was estimated. Priors are not stored, and outliers
/// are already removed. `estimate` must have a calibration and evidence.
CalibrationOptions options_of_file(const RigEstimate& estimate);

/// The same with calibrate()'s default camera names: left, right, camera2 … Use it for the options
/// passed to calibrate(), whose parameter names contain them.
RigEstimate with_default_names(RigEstimate estimate);

/// Compares a file's parameters and minimum variance bound with `again`, the solution from its
/// stored evidence. If the calibration had a prior, gives the reason why they are not compared.
CheckSection check_file(const RigEstimate& from_file, const RigEstimate& again);

}  // namespace vernier::cli
