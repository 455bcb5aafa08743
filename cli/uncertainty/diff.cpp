// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/covariance.h"
#include "calib/estimate/covariance_curvature.h"
#include "calib/estimate/projection_difference.h"
#include "calib/estimate/same_rig.h"
#include "calib/pose.h"
#include "calib/rig_difference.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/limited_grid.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"

namespace vernier::cli {
namespace {

constexpr double significance = 0.01;  // below this p the rigs differ
constexpr double too_close = 0.999;
constexpr int most_cells = 100'000;  // of the grid, in 1 GB

struct DiffArguments {
  std::string a, b, distances = "1,3,10,inf", grid = "20x15", covariance = "honest";
  double focus_share = 0.7;
};

/// The result of the comparison.
struct Comparison {
  RigEstimate a, b;
  std::optional<Covariance> covariance_a, covariance_b;
  std::optional<RigDifference> parameters;  ///< if both have a covariance
  ProjectionDifference projection;
  int shared_views = 0;
  std::vector<std::string> warnings;
};

RigEstimate load(const std::string& name, Comparison& found) {
  RigFile file = read_rig(find_rig(name));
  for (std::string& warning : file.warnings) found.warnings.push_back(std::move(warning));
  return std::move(file.estimate);
}

/// Adds warnings that limit the validity of the comparison.
void add_warnings(const DiffArguments& options, Comparison& found) {
  const auto warn = [&](std::string line) { found.warnings.push_back(std::move(line)); };
  for (const auto& [estimate, covariance, name] :
       {std::tuple(&found.a, &found.covariance_a, &options.a),
        std::tuple(&found.b, &found.covariance_b, &options.b)}) {
    if (!covariance->has_value()) {
      warn(fmt::format("{} has no {} covariance: only projections are compared", *name,
                       options.covariance == "mvb" ? "minimum variance" : "honest"));
    } else if (const auto doubt = curvature_warning(estimate->rig, **covariance)) {
      warn(*name + ": " + *doubt);
    }
  }
  if (found.projection.left_out > 0) {
    warn(
        fmt::format("{} grid points have no ray in one rig or lie behind the other, or have no "
                    "image in it; excluded",
                    found.projection.left_out));
  }
  if (found.a.evidence && found.b.evidence) {
    found.shared_views =
        shared_views(*found.a.evidence, found.a.rig, *found.b.evidence, found.b.rig);
  }
  if (found.shared_views > 0) {
    warn(
        fmt::format("{} of the {} images of {} were used for both calibrations, so their errors "
                    "are correlated: the expected difference and the p-value are too large, unless "
                    "the models differ",
                    found.shared_views, found.a.evidence->observations.views.size(), options.a));
  } else if (found.parameters && found.parameters->p_value > too_close) {
    warn(
        "the rigs agree better than their uncertainties predict: the uncertainties are too large, "
        "or both calibrations use the same images");
  }
}

Comparison compare(const DiffArguments& options) {
  Comparison found;
  found.a = load(options.a, found);
  found.b = load(options.b, found);
  check_same_cameras(found.a.rig, found.b.rig, options.b);
  const auto choice =
      options.covariance == "mvb" ? CovarianceChoice::mvb : CovarianceChoice::honest;
  found.covariance_a = chosen_covariance(found.a, choice);
  found.covariance_b = chosen_covariance(found.b, choice);
  const bool both = found.covariance_a && found.covariance_b;
  if (both) {
    found.parameters = with_errors_of(options.a + ", " + options.b, [&] {
      return rig_difference(found.a.rig, *found.covariance_a, found.b.rig, *found.covariance_b);
    });
  }
  const auto [columns, rows] = parse_image_grid(options.grid, "--grid", most_cells);
  const ProjectionDifferenceOptions how{
      .distances_m = parse_distances(options.distances, "--distances-m"),
      .grid = {columns, rows},
      .focus_share = options.focus_share};
  found.projection = with_errors_of(options.a + ", " + options.b, [&] {
    return projection_difference(found.a.rig, found.b.rig, how,
                                 both ? &*found.covariance_a : nullptr,
                                 both ? &*found.covariance_b : nullptr);
  });
  add_warnings(options, found);
  return found;
}

std::string verdict(const RigDifference& d) {
  if (!d.fixed_at_different_values.empty()) return "a parameter is fixed at different values";
  return fmt::format("the rigs {} their uncertainties (p = {:.2g})",
                     d.p_value < significance ? "differ beyond" : "agree within", d.p_value);
}

Json distance_json(double distance_m) {
  return std::isinf(distance_m) ? Json("inf") : Json(distance_m);
}

Json size_json(const DifferenceSize& size) {
  return {{"mean_px", size.mean_px}, {"rms_px", size.rms_px}, {"max_px", size.max_px}};
}

Json vectors_json(const std::vector<Eigen::Vector2d>& vectors) {
  Json list = Json::array();
  for (const Eigen::Vector2d& v : vectors) {
    list.push_back(v.allFinite() ? Json{v.x(), v.y()} : Json(nullptr));
  }
  return list;
}

Json projection_json(const Comparison& found) {
  const ProjectionDifference& p = found.projection;
  Json json{{"before", size_json(p.before)},
            {"after", size_json(p.after)},
            {"in_focus", size_json(p.in_focus)}};
  if (p.expected_rms_px) json["expected_rms_px"] = *p.expected_rms_px;
  json["left_out"] = p.left_out;
  json["cameras"] = Json::array();
  for (std::size_t c = 0; c < p.pixels_px.size(); ++c) {
    json["cameras"].push_back({{"name", found.a.rig.cameras[c].name},
                               {"pixels_px", vectors_json(p.pixels_px[c])},
                               {"distances", Json::array()}});
  }
  for (const DifferenceMap& map : p.maps) {
    Json m{{"distance_m", distance_json(map.distance_m)},
           {"before", size_json(map.before)},
           {"after", size_json(map.after)},
           {"in_focus", size_json(map.in_focus)}};
    if (p.expected_rms_px) {
      m["expected_rms_px"] = map.expected_rms_px;
      m["expected_in_focus_px"] = map.expected_in_focus_px;
    }
    m["before_px"] = vectors_json(map.before_px);
    m["after_px"] = vectors_json(map.after_px);
    if (p.expected_rms_px) m["expected_px"] = map.expected_px;
    json["cameras"][map.camera]["distances"].push_back(std::move(m));
  }
  return json;
}

void add_parameters(const RigDifference& d, Json& json) {
  json["mahalanobis"] = std::sqrt(d.mahalanobis2);  // null where infinite
  json["mahalanobis_squared"] = d.mahalanobis2;
  json["dof"] = d.dof;
  json["p_value"] = d.p_value;
  json["verdict"] = verdict(d);
  json["held_apart"] = d.fixed_at_different_values;
  json["parameters"] = Json::array();
  for (const ParameterDifference& p : d.parameters) {
    json["parameters"].push_back({{"name", p.name},
                                  {"a", p.a},
                                  {"b", p.b},
                                  {"difference", p.delta},
                                  {"sigma", p.sigma},
                                  {"in_sigma", p.held ? Json(nullptr) : Json(p.delta / p.sigma)}});
  }
  json["only_in_a"] = d.only_in_a;
  json["only_in_b"] = d.only_in_b;
  json["directions"] = Json::array();
  for (const DirectionDifference& direction : d.directions) {
    json["directions"].push_back(
        {{"in_sigma", direction.in_sigma}, {"words", direction.description}});
  }
}

Json comparison_json(const DiffArguments& options, const Comparison& found) {
  Json json{{"a", options.a}, {"b", options.b}, {"covariance", options.covariance}};
  for (const auto& [key, covariance] : {std::pair("covariance_kind_a", &found.covariance_a),
                                        std::pair("covariance_kind_b", &found.covariance_b)}) {
    json[key] = *covariance ? Json(name((*covariance)->kind)) : Json(nullptr);
  }
  if (found.parameters) add_parameters(*found.parameters, json);
  const Pose& T = found.projection.T_b_a;
  const Eigen::Vector3d w = vector_from_rotation(T.R) * 180 / std::numbers::pi;
  json["alignment"] = {{"rotation_deg", {w.x(), w.y(), w.z()}},
                       {"translation_m", {T.t.x(), T.t.y(), T.t.z()}}};
  json["projection"] = projection_json(found);
  json["shared_views"] = found.shared_views;
  json["warnings"] = found.warnings;
  return json;
}

std::string projection_text(const Comparison& found) {
  const ProjectionDifference& p = found.projection;
  const Eigen::Vector3d w = vector_from_rotation(p.T_b_a.R) * 180 / std::numbers::pi;
  const Eigen::Vector3d t = 1000 * p.T_b_a.t;
  std::string text = fmt::format(
      "projection difference b - a in pixels, before and after aligning the frames by a rotation "
      "of ({:.4f}, {:.4f}, {:.4f})° and a translation of ({:.2f}, {:.2f}, {:.2f}) mm\n{:<10} "
      "{:>10} {:>10} {:>10} {:>10} {:>10} {:>10} "
      "{:>10} {:>10}\n",
      w.x(), w.y(), w.z(), t.x(), t.y(), t.z(), "camera", "distance", "rms before", "mean after",
      "rms after", "max after", "expected", "rms focus", "expected");
  for (const DifferenceMap& map : p.maps) {
    const auto expected = [&](double px) {
      return p.expected_rms_px ? fmt::format("{:.3f}", px) : std::string("unknown");
    };
    text += fmt::format(
        "{:<10} {:>10} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f} {:>10} {:>10.3f} {:>10}\n",
        found.a.rig.cameras[map.camera].name, fmt::format("{} m", map.distance_m),
        map.before.rms_px, map.after.mean_px, map.after.rms_px, map.after.max_px,
        expected(map.expected_rms_px), map.in_focus.rms_px, expected(map.expected_in_focus_px));
  }
  return text;
}

std::string parameters_text(const RigDifference& d) {
  std::string text = fmt::format("\n{:<14} {:>14} {:>14} {:>12} {:>12} {:>9}\n", "parameter", "a",
                                 "b", "difference", "sigma", "in sigma");
  for (const ParameterDifference& p : d.parameters) {
    text +=
        fmt::format("{:<14} {:>14.8g} {:>14.8g} {:>12.3g} {:>12.3g} {:>9}\n", p.name, p.a, p.b,
                    p.delta, p.sigma, p.held ? "fixed" : fmt::format("{:.2f}", p.delta / p.sigma));
  }
  for (const auto& [only, rig] : {std::pair(&d.only_in_a, "a"), std::pair(&d.only_in_b, "b")}) {
    if (!only->empty()) text += fmt::format("only in {}: {}\n", rig, fmt::join(*only, " "));
  }
  text +=
      fmt::format("\nMahalanobis distance {:.3f} (squared: {:.2f}, {} degrees of freedom): {}\n",
                  std::sqrt(d.mahalanobis2), d.mahalanobis2, d.dof, verdict(d));
  for (const std::string& words : d.fixed_at_different_values) text += "  " + words + "\n";
  for (std::size_t k = 0; k < std::min<std::size_t>(3, d.directions.size()); ++k) {
    text += fmt::format("  {:.1f} sigma along a direction: {}\n", d.directions[k].in_sigma,
                        d.directions[k].description);
  }
  return text;
}

void run(const DiffArguments& options, Session& session) {
  const Comparison found = compare(options);
  for (const std::string& warning : found.warnings) session.warn(warning);
  std::string text = projection_text(found);
  if (found.parameters) text += parameters_text(*found.parameters);
  session.result(comparison_json(options, found), text);
}

}  // namespace

void add_diff(CLI::App& app, Session& session) {
  auto o = std::make_shared<DiffArguments>();
  CLI::App* verb = add_verb(
      app, session, "diff",
      "compare two calibrations of the same cameras: projection difference and statistical test",
      "vernier diff monday.rig.json friday.rig.json --distances-m 1,5,inf");
  verb->add_option("a", o->a, "rig file")->required();
  verb->add_option("b", o->b, "rig file")->required();
  verb->add_option("--distances-m", o->distances,
                   "distances of the compared points along their rays, metres; inf for infinity")
      ->capture_default_str();
  verb->add_option("--grid", o->grid, "grid of compared pixels, columns x rows")
      ->capture_default_str();
  verb->add_option("--focus", o->focus_share,
                   "radius for fitting the alignment, as a fraction of half the image diagonal")
      ->check(finite_and_positive)
      ->check(CLI::Range(0.05, 1.0))
      ->capture_default_str();
  verb->add_option("--covariance", o->covariance,
                   "honest (used for sampling) or mvb (minimum variance bound)")
      ->check(CLI::IsMember({"honest", "mvb"}))
      ->capture_default_str();
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
