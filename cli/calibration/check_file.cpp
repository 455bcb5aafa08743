// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/check_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calib/board_state.h"
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

/// The components and the shape of random effects, relative to the largest there is of each unit.
ToleranceCheck effects_gate(const CalibrationEffects& from_file, const CalibrationEffects& again) {
  ToleranceCheck worst{"random effects, relative", "max_effects_diff", "", 0, gate};
  const auto compare = [&](const std::string& name, double a, double b, double unit) {
    const double relative = a == b ? 0 : std::abs(a - b) / unit;
    if (!is_worse(relative, worst.value)) return;
    worst.value = relative;
    worst.where = name;
  };
  compare("white_px", from_file.white_px, again.white_px, again.white_px);
  compare("field_px", from_file.field_px, again.field_px, again.white_px);
  compare("field_length_m", from_file.field_length_m, again.field_length_m, again.field_length_m);
  compare("motion_m", from_file.motion_m, again.motion_m, again.motion_m);
  compare("motion_baseline_m", from_file.motion_baseline_m, again.motion_baseline_m,
          again.motion_baseline_m);
  compare("motion_rad", from_file.motion_rad, again.motion_rad, again.motion_rad);
  const double height_m = std::hypot(again.shape_height_m, again.shape_plane_m);
  compare("shape_height_m", from_file.shape_height_m, again.shape_height_m, height_m);
  compare("shape_plane_m", from_file.shape_plane_m, again.shape_plane_m, height_m);
  for (std::size_t i = 0; i < again.shape_m.size(); ++i) {
    compare("shape_m", (from_file.shape_m[i] - again.shape_m[i]).norm(), 0, height_m);
  }
  return worst;
}

}  // namespace

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
  const std::optional<CalibrationEffects>& effects = from_file.calibration->effects;
  if (effects && again.calibration->effects) {
    gates.push_back(effects_gate(*effects, *again.calibration->effects));
  }
  add_gates("file against solving again", "solving again", gates, part);
  if (!from_file.covariance_mvb) part.text += "  the file has no covariance_mvb to compare\n";
  return part;
}

}  // namespace vernier::cli
