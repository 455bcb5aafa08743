// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/check_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/camera/model_nesting.h"
#include "calib/covariance.h"
#include "calib/mrcal/mrcal_comparison.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "cli/calibration/check_section.h"

namespace vernier::cli {
namespace {

/// A minimum found by Ceres alone (free warp) is about 1e-6 standard deviations off; the bound of
/// opencv8 is accurate to five digits.
constexpr double gate = 1e-4;

ToleranceCheck parameter_gate(const Rig& from_file, const RigEstimate& again) {
  ToleranceCheck worst{"parameters, in standard deviations", "max_parameter_diff_sigma", "", 0,
                       gate};
  const std::vector<std::string> names = parameter_names(from_file);
  const Eigen::VectorXd delta = difference(from_file, again.rig);
  const Eigen::VectorXd sd = again.covariance_mvb->diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < delta.size(); ++i) {
    if (sd[i] == 0) continue;  // fixed in the file
    const double in_sigma = std::abs(delta[i]) / sd[i];
    if (!is_worse(in_sigma, worst.value)) continue;
    worst.value = in_sigma;
    worst.where = names[static_cast<std::size_t>(i)];
  }
  return worst;
}

ToleranceCheck covariance_gate_of(const RigEstimate& from_file, const RigEstimate& again) {
  const Eigen::MatrixXd &A = *from_file.covariance_mvb, &B = *again.covariance_mvb;
  CovarianceDifference worst = normalised_difference(A, B);
  for (int i = 0; i < static_cast<int>(B.rows()); ++i) {  // fixed parameters have no variance
    if (B(i, i) == 0 && A(i, i) != 0) worst = {std::numeric_limits<double>::infinity(), i, i};
  }
  const std::vector<std::string> names = parameter_names(from_file.rig);
  return {"covariance_mvb, normalised", "max_covariance_diff",
          names[worst.row] + ", " + names[worst.column], worst.largest, gate};
}

}  // namespace

CalibrationOptions options_of_file(const RigEstimate& estimate) {
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

CheckSection check_file(const RigEstimate& from_file, const RigEstimate& again) {
  CheckSection part;
  if (from_file.calibration->prior_dof > 0 && from_file.evidence->priors.empty()) {
    part.reason =
        "the file does not contain the prior of its calibration, so its values are not compared "
        "with solving again; the other checks run without the prior";
    part.text = part.reason + "\n";
    return part;
  }
  std::vector<ToleranceCheck> gates{parameter_gate(from_file.rig, again)};
  if (from_file.covariance_mvb) gates.push_back(covariance_gate_of(from_file, again));
  add_gates("file against solving again", "solving again", gates, part);
  if (!from_file.covariance_mvb) part.text += "  the file has no covariance_mvb to compare\n";
  return part;
}

}  // namespace vernier::cli
