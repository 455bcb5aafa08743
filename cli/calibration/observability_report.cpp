// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/observability_report.h"

#include <algorithm>
#include <cmath>

#include "calib/covariance.h"
#include "calib/data_and_prior.h"
#include "calib/joint_calibration.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/triangulation_uncertainty.h"
#include "cli/program/session.h"
#include "stereo/rectification/vertical_disparity.h"

namespace vernier::cli {
namespace {

/// At which disparity and depth uncertainty are reported: the first where both cameras see
/// anything.
constexpr double ranges_m[] = {3, 30};

/// Effect of the rig's covariance on disparity and depth.
struct Downstream {
  double vertical_disparity_px = 0;  ///< NaN if nothing is in view of both cameras
  double depth_m = 0;
};
Downstream downstream(const Rig& rig, const Eigen::MatrixXd& covariance, double range_m) {
  RigEstimate estimate;
  estimate.rig = rig;
  estimate.covariance = Covariance{CovarianceKind::prior, parameter_names(rig), covariance};
  return {vertical_disparity_map(rig, covariance, 20, 15, range_m).rms_px,
          depth_uncertainty(estimate, {range_m}, {.samples = 2}).front().sigma_linear_m};
}

}  // namespace

ObservabilityReport report_observability(const JointCalibration& joint,
                                         const Eigen::MatrixXd& covariance_before) {
  ObservabilityReport report;
  if (!joint.observability) return report;
  const Observability& o = *joint.observability;
  const Rig& rig = joint.estimate.rig;
  Downstream after;
  double range_m = 0;
  for (const double range : ranges_m) {
    range_m = range;
    after = downstream(rig, joint.estimate.covariance->matrix, range_m);
    if (!std::isnan(after.vertical_disparity_px)) break;
  }
  const Downstream before = downstream(rig, covariance_before, range_m);
  std::string& text = report.text;
  text += "information from the pairs (ratio of standard deviations after / before; 1: none):\n";
  for (const ObservedDirection& d : o.directions) {
    text += fmt::format("  {:8.4f}  {}\n", d.sd_ratio, d.description);
  }
  text += fmt::format(
      "the pairs determine {:.1f} of {} parameters: sigma at least halved in {} directions, "
      "unchanged in {}\n",
      std::max(0.0, o.from_data), o.directions.size(), o.improved, o.unchanged);
  text += fmt::format("noise of the pairs: {:.3g} times the value in the pairs file\n",
                      joint.pair_sigma_scale);
  text += fmt::format(
      "the baseline length is not observable from pairs: its sigma (bound) is {:.4g} mm before and "
      "{:.4g} mm after; all depths scale with it\n",
      1e3 * o.baseline_sd_before_m, 1e3 * o.baseline_sd_after_m);
  if (std::isnan(after.vertical_disparity_px)) {
    report.warning = fmt::format(
        "at {:g} m nothing is in view of both cameras, whose baseline is {:.4g} m: are the lengths "
        "of the prior in metres?",
        range_m, rig.T_camera_first[1].t.norm());
  } else {
    text += fmt::format(
        "at {:g} m: vertical disparity {:.3g} px rms before, {:.3g} px after; depth sigma {:.3g} m "
        "before, {:.3g} m after\n",
        range_m, before.vertical_disparity_px, after.vertical_disparity_px, before.depth_m,
        after.depth_m);
  }
  Json& json = report.json;
  json = {{"from_data", o.from_data},
          {"improved", o.improved},
          {"unchanged", o.unchanged},
          {"mostly_prior", o.is_prior_dominated()},
          {"scale_information_ratio", o.scale_information_ratio},
          {"baseline_sd_m", {o.baseline_sd_before_m, o.baseline_sd_after_m}},
          {"range_m", range_m},
          {"vertical_disparity_px",
           {json_number(before.vertical_disparity_px), json_number(after.vertical_disparity_px)}},
          {"depth_sigma_m", {before.depth_m, after.depth_m}}};
  json["directions"] = Json::array();
  for (const ObservedDirection& d : o.directions) {
    json["directions"].push_back({{"sd_ratio", d.sd_ratio}, {"words", d.description}});
  }
  return report;
}

}  // namespace vernier::cli
