// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/calibration/effects.h"
#include "calib/rig_estimate.h"
#include "calib/validation/model_comparison.h"
#include "cli/program/namespaces.h"

namespace vernier::cli {

/// What is looked for beside the rig.
struct LookFor {
  bool effects = true;
  bool models = true;
};

/// A calibration, the lens models it was compared with, and the test of its random effects.
struct FoundCalibration {
  RigEstimate estimate;
  ModelComparison comparison;
  EffectsTest test;
};

/// calibrate(), then the comparison of its lens model with richer ones, then the random effects of
/// the board. These are not looked for where a richer lens model predicts better: its misfit would
/// be taken for them. The effects that were found are set in the options.
FoundCalibration calibrate_and_look(const BoardObservations& observations,
                                    CalibrationOptions& options,
                                    LookFor look);

}  // namespace vernier::cli
