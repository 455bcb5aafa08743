// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/report/report_calibration.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibration/solve_again.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/triangulation_uncertainty.h"
#include "cli/program/rig_table.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

std::vector<double> list(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

Json depth_json(const RigEstimate& estimate) {
  Json rows = Json::array();
  for (const DepthUncertainty& u : depth_uncertainty(estimate, {0.5, 1, 2, 3, 5, 7, 10, 15, 20})) {
    rows.push_back({{"range_m", u.range_m},
                    {"sigma_linear_m", u.sigma_linear_m},
                    {"sigma_sampled_m", u.sigma_sampled_m},
                    {"non_physical_share", u.non_physical_share}});
  }
  return rows;
}

/// Correlation matrix of the estimated parameters, with their names.
void add_correlation(const Covariance& covariance, Json& json) {
  const Eigen::VectorXd sd = covariance.matrix.diagonal().cwiseMax(0).cwiseSqrt();
  json["correlation_names"] = Json::array();
  json["correlation"] = Json::array();
  for (Eigen::Index i = 0; i < sd.size(); ++i) {
    if (!(sd[i] > 0)) continue;
    json["correlation_names"].push_back(covariance.names[i]);
    Json row = Json::array();
    for (Eigen::Index j = 0; j < sd.size(); ++j) {
      if (!(sd[j] > 0)) continue;
      row.push_back(std::round(1e6 * covariance.matrix(i, j) / (sd[i] * sd[j])) / 1e6);
    }
    json["correlation"].push_back(std::move(row));
  }
}

Json summary_json(const RigEstimate& estimate) {
  const CalibrationSummary& s = *estimate.calibration;
  Json json{{"source", s.source},
            {"rms_px", s.rms_px},
            {"pixel_sigma_px", s.pixel_sigma_px},
            {"chi2", s.chi2},
            {"dof", s.dof},
            {"views", s.views},
            {"corners_left_out", s.outliers.size()},
            {"held", s.held},
            {"prior_dof", s.prior_dof},
            {"prior_chi2", s.prior_chi2},
            {"warnings", s.warnings},
            {"doubts", s.trust_warnings}};
  if (s.effects) json["effects"] = effects_json(*s.effects);
  if (s.board_aspect) json["board_aspect"] = aspect_json(*s.board_aspect);
  if (estimate.evidence) {
    const CalibrationEvidence& evidence = *estimate.evidence;
    std::size_t corners = 0;
    for (const BoardView& view : evidence.observations.views) corners += view.ids.size();
    json["corners_used"] = corners;
    json["images"] = evidence.observations.views.size();
    if (!evidence.warp_m.isZero(0)) json["warp_m"] = {evidence.warp_m.x(), evidence.warp_m.y()};
  }
  return json;
}

void add_covariance(const RigEstimate& estimate, Json& json) {
  const ScaledDecomposition decomposition(*estimate.covariance);
  const Json table = rig_json(estimate);
  json["sigma"] = table["sigma"];
  json["kind"] = name(estimate.covariance->kind);
  json["raw_condition"] = decomposition.raw_condition();
  json["scaled_condition"] = decomposition.scaled_condition();
  json["directions"] = table["directions"];
  const std::vector<bool> held = held_parameters(estimate);
  json["free_parameters"] = std::count(held.begin(), held.end(), false);
  add_correlation(*estimate.covariance, json);
  if (estimate.rig.cameras.size() == 2) json["depth"] = depth_json(estimate);
}

/// Whether the covariance is the bound and the scatter of the views agrees with white noise, so
/// that the bound is valid. True for simulated views, usually not for real images.
bool is_true_bound(const RigEstimate& estimate, const Json& views) {
  if (!estimate.covariance || estimate.covariance->kind != CovarianceKind::mvb) return false;
  double pull = 0, noise = 0;  // squared; the page shows their ratio
  for (const Json& view : views) {
    if (!view["influence"].is_number() || !view["influence_noise"].is_number()) return false;
    pull += std::pow(view["influence"].get<double>(), 2);
    noise += std::pow(view["influence_noise"].get<double>(), 2);
  }
  return noise > 0 && pull < 1.2 * 1.2 * noise;
}

/// Removes the warning that older rig files contain for every bound.
void drop_warning_of_bound(Json& warnings) {
  Json kept = Json::array();
  for (Json& one : warnings) {
    const bool of_bound =
        one.get_ref<const std::string&>().starts_with("covariance is the minimum variance bound");
    if (!of_bound) kept.push_back(std::move(one));
  }
  warnings = std::move(kept);
}

/// Appends warnings, without duplicates.
void add_warnings(const Json& more, Json& warnings) {
  for (const Json& one : more) {
    if (std::find(warnings.begin(), warnings.end(), one) == warnings.end()) warnings.push_back(one);
  }
}

}  // namespace

Json report_rig(const RigEstimate& estimate,
                const std::string& file,
                Validation proof,
                const Session& session) {
  Json json{{"file", file}, {"cameras", Json::array()}};
  std::set<std::string> models;
  for (const Camera& camera : estimate.rig.cameras) {
    models.emplace(model_name(camera.model));
    json["cameras"].push_back({{"name", camera.name},
                               {"model", model_name(camera.model)},
                               {"size_px", {camera.size_px[0], camera.size_px[1]}}});
  }
  json["name"] = fmt::format("{}, {}", file, fmt::join(models, " and "));
  json["names"] = parameter_names(estimate.rig);
  json["values"] = list(parameters(estimate.rig));
  json["sigma_mvb"] = rig_json(estimate).value("sigma_mvb", Json(nullptr));
  json["calibration"] = estimate.calibration ? summary_json(estimate) : Json(nullptr);
  if (estimate.covariance) add_covariance(estimate, json);
  if (!estimate.evidence || !estimate.calibration || estimate.evidence->frames.empty()) {
    json["missing"] =
        "This rig file does not contain its calibration data (it was written by hand or with "
        "--no-evidence): corners, residuals, projection uncertainty, view influence and "
        "cross-validation cannot be shown.";
    return json;
  }
  const RigEstimate usual = without_effects(estimate);
  json["corners"] = report_corners(usual);
  if (estimate.covariance) {
    json["projection"] = report_projection(estimate);
    if (estimate.covariance_mvb || estimate.covariance->kind == CovarianceKind::mvb) {
      json["view_influence"] = report_views(usual);
      json["true_bound"] = is_true_bound(estimate, json["view_influence"]);
      if (json["true_bound"]) drop_warning_of_bound(json["calibration"]["warnings"]);
    }
  }
  if (proof == Validation::make) {
    json["proof"] = report_validation(estimate, usual, file, session);
    add_warnings(json["proof"]["warnings"], json["calibration"]["warnings"]);
  }
  return json;
}

}  // namespace vernier::cli
