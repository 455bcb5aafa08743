// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/found_effects.h"

#include <utility>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/calibration/effects.h"
#include "calib/calibration/solve_again.h"
#include "calib/rig_estimate.h"
#include "calib/validation/model_comparison.h"

namespace vernier::cli {

namespace {

/// For a motion that was asked for: whether it is along the baseline, which is then set in the
/// options and estimated. The estimate is kept where its corners are not tested.
void look_along_baseline(const BoardObservations& observations,
                         CalibrationOptions& options,
                         FoundCalibration& found) {
  CalibrationOptions usual = options;
  usual.board_shape = usual.motion = usual.board_aspect = false;
  const EffectsTest test = test_effects(without_effects(found.estimate), usual);
  found.test.isotropy = test.isotropy;
  if (!test.along_baseline) return;
  options.baseline_motion = true;
  found.estimate = calibrate(observations, options);
}

}  // namespace

FoundCalibration calibrate_and_look(const BoardObservations& observations,
                                    CalibrationOptions& options,
                                    LookFor look) {
  FoundCalibration found;
  found.estimate = calibrate(observations, options);
  if (look.models) {
    CalibrationOptions usual = options;
    usual.board_shape = usual.motion = usual.board_aspect = false;
    found.comparison = compare_models(without_effects(found.estimate), usual);
  }
  if (options.motion) look_along_baseline(observations, options, found);
  if (!look.effects) return found;
  if (!found.comparison.warnings.empty()) {
    found.test.not_tested = "a richer lens model predicts held-out views better";
    return found;
  }
  found.estimate = with_found_effects(std::move(found.estimate), observations, options, found.test);
  return found;
}

}  // namespace vernier::cli
