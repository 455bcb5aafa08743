// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/rig_estimate.h"

namespace vernier::internal {

/// How a lens model predicts views it has not seen.
struct ModelScore {
  std::vector<CameraModel> models;  ///< one a camera
  std::string name;                 ///< such as "opencv4"
  double held_out_rms_px = 0;       ///< per coordinate, over views left out of the calibration
  double fitted_rms_px = 0;         ///< per coordinate, over all views
  int better_views = 0;             ///< left-out views it predicts better than the model in use
  double gain_sigmas = 0;  ///< its gain in squared error a view over the scatter of that gain
  /// Largest move of a parameter other than distortion, in honest standard deviations of the
  /// model in use, with its name.
  double largest_move_sigmas = 0;
  std::string largest_move;
};

/// No covariance covers model error: this asks whether a richer lens model
/// (calib/camera/model_nesting.h) predicts better, by leaving views out. The frames are dealt into
/// at most eight groups, those that the same cameras saw evenly; each group is left out in turn,
/// every model calibrated on the rest (which must determine it), and a left-out frame's squared
/// error taken after fitting its board's pose alone. With more than `max_frames`, evenly spaced
/// ones stand for all.
struct ModelComparison {
  ModelScore in_use;
  std::vector<ModelScore> richer;     ///< the next two, those that the views can determine
  int frames = 0;                     ///< compared
  std::vector<std::string> warnings;  ///< what a person should do about it
  std::string not_compared;           ///< why there are no scores
};

/// `estimate` is calibrate(observations, options)'s result. Nothing to compare (no richer model, or
/// fewer than six frames) gives no scores and no warnings, nor does a model in use that cannot be
/// calibrated without some group; `not_compared` says so. Throws Error for an estimate without
/// evidence, covariance or summary.
ModelComparison compare_models(const RigEstimate& estimate,
                               const CalibrationOptions& options,
                               int max_frames = 60);

}  // namespace vernier::internal
