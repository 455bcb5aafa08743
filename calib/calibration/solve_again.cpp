// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/solve_again.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

CalibrationOptions options_to_solve_again(const RigEstimate& estimate) {
  const CalibrationSummary& summary = *estimate.calibration;
  CalibrationOptions options;
  options.models = models_of(estimate.rig);
  const std::vector<std::string> names = parameter_names(estimate.rig);
  const Eigen::VectorXd values = parameters(estimate.rig);
  for (const std::string& held : summary.held) {
    const auto i = std::find(names.begin(), names.end(), held) - names.begin();
    if (i < values.size()) options.held.push_back({held, values[i]});
  }
  // If the noise was estimated from the residuals, χ² equals the degrees of freedom.
  const bool estimated = std::abs(summary.chi2 / summary.dof - 1) < 1e-6;
  options.pixel_sigma_px = estimated ? 0 : summary.pixel_sigma_px;
  const std::vector<GaussianRigPrior>& priors = estimate.evidence->priors;
  if (!priors.empty()) options.prior = priors[0];
  if (priors.size() > 1) {  // priors of single parameters (--know) follow a file's
    const GaussianRigPrior& known = priors[1];
    const std::vector<std::string> all = parameter_names(known.rig);
    for (std::size_t i = 0; i < known.covariance.names.size(); ++i) {
      const std::string& name = known.covariance.names[i];
      const auto k = static_cast<Eigen::Index>(i);
      const auto at = std::find(all.begin(), all.end(), name) - all.begin();
      options.known.push_back(
          {name, parameters(known.rig)[at], std::sqrt(known.covariance.matrix(k, k))});
    }
  }
  options.warp = estimate.evidence->warp_m.isZero(0) ? BoardWarp::known : BoardWarp::free;
  if (summary.effects) {
    options.pixel_sigma_px = 0;       // with a prior the degrees of freedom are rounded
    options.warp = BoardWarp::known;  // a shape contains it
    options.board_shape = !summary.effects->shape_m.empty();
    options.motion = summary.effects->motion_m > 0;
    options.baseline_motion = summary.effects->motion_baseline_m > 0;
  }
  options.board_aspect = summary.board_aspect.has_value();
  if (options.board_aspect) options.pixel_sigma_px = 0;
  options.reject_outliers = false;
  options.check_input = false;
  options.white_noise = estimate.covariance && estimate.covariance->kind == CovarianceKind::mvb;
  return options;
}

RigEstimate with_default_names(RigEstimate estimate) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < estimate.rig.cameras.size(); ++i) {
    names.push_back(default_camera_name(i));
  }
  rename_cameras(estimate, names);
  return estimate;
}

RigEstimate without_effects(const RigEstimate& estimate) {
  if (!estimate.calibration) return estimate;
  if (!estimate.calibration->effects && !estimate.calibration->board_aspect) return estimate;
  if (!estimate.evidence || estimate.evidence->observations.views.empty()) return estimate;
  CalibrationOptions options = options_to_solve_again(with_default_names(estimate));
  options.board_shape = options.motion = options.board_aspect = false;
  RigEstimate usual = calibrate(estimate.evidence->observations, options);
  std::vector<std::string> names;
  for (const Camera& camera : estimate.rig.cameras) names.push_back(camera.name);
  rename_cameras(usual, names);
  usual.calibration = estimate.calibration;  // with the outliers and warnings of the corners
  usual.calibration->effects.reset();
  usual.calibration->board_aspect.reset();
  return usual;
}

}  // namespace vernier::internal
