// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/calibrate.h"
#include "calib/rig_estimate.h"
#include "cli/calibration/check_section.h"

#include "cli/program/namespaces.h"

namespace vernier::cli {

/// The options that `estimate` was calibrated with, as far as its file tells: models, held
/// parameters, a free warp, and a noise that is estimated again where it was. Without priors, which
/// no file holds; its outliers are out already. `estimate` must have a calibration and evidence.
CalibrationOptions options_of_file(const RigEstimate& estimate);

/// The same with the names that calibrate() gives cameras: left, right, camera2 … Options that it
/// is to understand are those of such an estimate.
RigEstimate with_default_names(RigEstimate estimate);

/// What a file states, parameters and minimum variance bound, against `again`, the solution of the
/// problem that its evidence is. Where there was a prior, the reason why they are not compared.
CheckSection check_file(const RigEstimate& stated, const RigEstimate& again);

}  // namespace vernier::cli
