// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// Prediction of held-out views by a lens model.
struct ModelScore {
  std::vector<CameraModel> models;  ///< one per camera
  std::string name;                 ///< such as "opencv4"
  double held_out_rms_px = 0;       ///< per coordinate, over views left out of the calibration
  double fitted_rms_px = 0;         ///< per coordinate, over all views
  int better_views = 0;             ///< held-out views it predicts better than the model in use
  double gain_sigmas = 0;  ///< gain in squared error per view over the scatter of that gain
  /// Largest change of a parameter other than distortion, in honest standard deviations of the
  /// model in use, with its name.
  double largest_move_sigmas = 0;
  std::string largest_move;
};

/// Tests for model error, which no covariance covers: does a richer lens model
/// (calib/camera/model_nesting.h) predict held-out views better? The frames are dealt into at most
/// eight groups, those seen by the same cameras evenly; each group is held out in turn, every model
/// is calibrated on the rest (which must determine it), and the squared error of a held-out frame
/// is taken after fitting only its board's pose. With more than `max_frames`, evenly spaced ones
/// are used.
struct ModelComparison {
  ModelScore in_use;
  std::vector<ModelScore> richer;     ///< the next two, if the views determine them
  int frames = 0;                     ///< compared
  std::vector<std::string> warnings;  ///< with remedies
  std::string left_out;               ///< the next model without a score, and why
  std::string not_compared;           ///< why there are no scores
};

/// `estimate` is calibrate(observations, options)'s result. If nothing can be compared (no richer
/// model, fewer than six frames, a richer or the model in use that some views do not determine),
/// there are no scores and no warnings, and `not_compared` gives the reason. Throws Error for an
/// estimate without evidence, covariance or summary.
ModelComparison compare_models(const RigEstimate& estimate,
                               const CalibrationOptions& options,
                               int max_frames = 60);

}  // namespace vernier::internal
