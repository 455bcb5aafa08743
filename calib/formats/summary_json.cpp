// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/shown_text.h"
#include "calib/board_observations.h"
#include "calib/camera/rig_limits.h"
#include "calib/error.h"
#include "calib/formats/rig_json.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"

namespace vernier::internal::rig_json {

std::vector<std::string> parse_texts(const Node& node, const std::string& key) {
  std::vector<std::string> texts;
  if (!node.has(key)) return texts;
  for (std::size_t i = 0; i < node.at(key).array().size(); ++i) {
    texts.push_back(node.at(key).at(i).text());
  }
  return texts;
}

namespace {

constexpr const char* remedy = "calibrate again";

/// A number of at least 0 and at most `most`.
double not_negative(const Node& node, double most = most_variance) {
  const double value = node.number();
  if (value < 0) throw Error(node.place(), "is negative", remedy);
  if (value > most) throw Error(node.place(), fmt::format("is above {:g}", most), remedy);
  return value;
}

int count(const Node& node) {
  const int value = node.integer();
  if (value < 0) throw Error(node.place(), "is negative", remedy);
  return value;
}

CornerOutlier parse_outlier(const Node& node, const Rig& rig) {
  CornerOutlier outlier;
  outlier.frame = node.at("frame").integer();
  outlier.camera = camera_index(node.at("camera"), rig);
  outlier.id = count(node.at("corner"));
  if (node.has("image")) outlier.image = node.at("image").text();
  const Node pixel = node.at("pixel_px");
  const Eigen::VectorXd q = pixel.vector();
  if (q.size() != 2) throw Error(pixel.place(), "is not a pixel", "");
  check_bounded(q, most_side_px, pixel);
  outlier.pixel_px = q;
  outlier.residual_px = node.at("residual_px").json().is_null()
                            ? std::numeric_limits<double>::quiet_NaN()
                            : not_negative(node.at("residual_px"));
  return outlier;
}

std::string parse_source(const Node& node) {
  constexpr std::array known{"board", "pairs", "combined"};
  std::string source = node.text();
  if (std::find(known.begin(), known.end(), source) == known.end()) {
    throw Error(node.place(), in_quotes(source) + " is unknown", "use board, pairs or combined");
  }
  return source;
}

/// Names of held parameters. Unknown names are rejected, since they would be freed silently.
std::vector<std::string> parse_held(const Node& node, const Rig& rig) {
  std::vector<std::string> held = parse_texts(node, "held");
  const std::vector<std::string> names = parameter_names(rig);
  for (std::size_t i = 0; i < held.size(); ++i) {
    const std::string place = node.at("held").at(i).place();
    if (std::find(names.begin(), names.end(), held[i]) == names.end()) {
      throw Error(place, "the rig has no parameter " + in_quotes(held[i]),
                  "use a name from parameter_names");
    }
    if (std::find(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(i), held[i]) !=
        held.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw Error(place, "repeats " + in_quotes(held[i]), "name it once");
    }
  }
  return held;
}

/// The priors' part of the cost, and the number of parameters with a prior: both or none.
void parse_prior_terms(const Node& node, CalibrationSummary& summary) {
  if (!node.has("prior_chi2") && !node.has("prior_dof")) return;
  summary.prior_chi2 = not_negative(node.at("prior_chi2"));
  summary.prior_dof = count(node.at("prior_dof"));
  if (summary.prior_dof == 0 && summary.prior_chi2 > 0) {
    throw Error(node.at("prior_chi2").place(), "is above 0 for no parameter", remedy);
  }
}

using EffectKey = std::pair<const char*, double CalibrationEffects::*>;
constexpr std::array<EffectKey, 7> effect_keys{
    {{"white_px", &CalibrationEffects::white_px},
     {"field_px", &CalibrationEffects::field_px},
     {"field_length_m", &CalibrationEffects::field_length_m},
     {"motion_rad", &CalibrationEffects::motion_rad},
     {"motion_m", &CalibrationEffects::motion_m},
     {"shape_plane_m", &CalibrationEffects::shape_plane_m},
     {"shape_height_m", &CalibrationEffects::shape_height_m}}};

constexpr const char* baseline_key = "motion_baseline_m";

CalibrationEffects parse_effects(const Node& node) {
  CalibrationEffects effects;
  for (const auto& [key, member] : effect_keys)
    effects.*member = not_negative(node.at(key), most_value);
  if (node.has(baseline_key)) {  // not in older files, nor where the motion is isotropic
    effects.motion_baseline_m = not_negative(node.at(baseline_key), most_value);
  }
  if (!(effects.white_px > 0)) throw Error(node.at("white_px").place(), "is not above 0", remedy);
  const bool has_shape = effects.shape_plane_m > 0 || effects.shape_height_m > 0;
  if (has_shape != node.has("shape_m")) {
    throw Error(node.place(), has_shape ? "has no shape_m" : "has a shape_m of no height", remedy);
  }
  if (!has_shape && !(effects.motion_m > 0)) {
    throw Error(node.place(), "has neither shape nor motion", remedy);
  }
  if (!has_shape) return effects;
  const Node shape = node.at("shape_m");
  const Eigen::VectorXd values = shape.vector();
  if (values.size() % 3 != 0) throw Error(shape.place(), "is not x, y, z of each point", remedy);
  check_bounded(values, most_value, shape);
  for (Eigen::Index i = 0; i < values.size(); i += 3) {
    effects.shape_m.emplace_back(values.segment<3>(i));
  }
  return effects;
}

Json effects_json(const CalibrationEffects& effects) {
  Json json;
  for (const auto& [key, member] : effect_keys) json[key] = effects.*member;
  if (effects.motion_baseline_m > 0) json[baseline_key] = effects.motion_baseline_m;
  if (effects.shape_m.empty()) return json;
  json["shape_m"] = Json::array();
  for (const Eigen::Vector3d& s : effects.shape_m) {
    for (const double value : s) json["shape_m"].push_back(value);
  }
  return json;
}

AspectEstimate parse_aspect(const Node& node) {
  const AspectEstimate aspect{node.at("value").number(), not_negative(node.at("sigma"), 1)};
  check_bounded(Eigen::VectorXd::Constant(1, aspect.value), 1, node.at("value"));
  return aspect;
}

}  // namespace

CalibrationSummary parse_summary(const Node& node, const Rig& rig) {
  CalibrationSummary summary;
  summary.source = parse_source(node.at("source"));
  summary.pixel_sigma_px = not_negative(node.at("pixel_sigma_px"), most_side_px);
  summary.rms_px = not_negative(node.at("rms_px"), most_side_px);
  summary.chi2 = not_negative(node.at("chi2"));
  summary.dof = count(node.at("dof"));
  summary.views = count(node.at("views"));
  parse_prior_terms(node, summary);
  if (node.has("effects")) summary.effects = parse_effects(node.at("effects"));
  if (node.has("board_aspect")) summary.board_aspect = parse_aspect(node.at("board_aspect"));
  summary.held = parse_held(node, rig);
  if (node.has("outliers")) {
    for (std::size_t i = 0; i < node.at("outliers").array().size(); ++i) {
      summary.outliers.push_back(parse_outlier(node.at("outliers").at(i), rig));
    }
  }
  if (node.has("pair_outliers")) {
    const Node list = node.at("pair_outliers");
    for (std::size_t i = 0; i < list.array().size(); ++i) {
      summary.pair_outliers.push_back(parse_pair_outlier(list.at(i)));
    }
  }
  summary.warnings = parse_texts(node, "warnings");
  summary.trust_warnings = parse_texts(node, "doubts");
  return summary;
}

namespace {

/// σ² χ² = Σ r² of corners; a pair has a standard deviation of its own.
void check_squares(const CalibrationSummary& summary, double coordinates, const Node& node) {
  constexpr double rounded_by_hand = 0.01;
  const double stated = std::pow(summary.pixel_sigma_px, 2) * summary.chi2;
  const double squares = std::pow(summary.rms_px, 2) * coordinates;
  if (std::abs(stated - squares) <= rounded_by_hand * std::max(stated, squares)) return;
  throw Error(node.place(),
              fmt::format("its chi2, pixel_sigma_px and rms_px disagree: {:.4g} px² and {:.4g} "
                          "px² for the sum of squared residuals",
                          stated, squares),
              remedy);
}

}  // namespace

void check_summary(const CalibrationSummary& summary,
                   const CalibrationEvidence& evidence,
                   const Node& node) {
  const BoardObservations& boards = evidence.observations;
  double coordinates = 0;
  for (const BoardView& view : boards.views) coordinates += 2.0 * view.pixels_px.size();
  const auto views = evidence.frames.size() + evidence.pairs.image_pairs.size();
  if (static_cast<std::size_t>(summary.views) != views) {
    throw Error(node.at("views").place(),
                fmt::format("is {}, and the evidence has {}", summary.views, views), remedy);
  }
  const double residuals = coordinates + static_cast<double>(evidence.pairs.size());
  if (summary.dof > residuals) {
    throw Error(node.at("dof").place(),
                fmt::format("is {}, and the evidence has {} residuals", summary.dof, residuals),
                remedy);
  }
  for (std::size_t i = 0; i < summary.outliers.size(); ++i) {
    if (static_cast<std::size_t>(summary.outliers[i].id) < boards.target_m.size()) continue;
    throw Error(node.at("outliers").at(i).place(),
                fmt::format("is corner {} of a board of {}", summary.outliers[i].id,
                            boards.target_m.size()),
                remedy);
  }
  if (summary.effects && !summary.effects->shape_m.empty() &&
      summary.effects->shape_m.size() != boards.target_m.size()) {
    throw Error(node.at("effects").at("shape_m").place(),
                fmt::format("is of {} points of a board of {}", summary.effects->shape_m.size(),
                            boards.target_m.size()),
                remedy);
  }
  for (std::size_t i = 0; i < summary.pair_outliers.size(); ++i) {
    if (summary.pair_outliers[i].row < evidence.pairs.size()) continue;
    throw Error(node.at("pair_outliers").at(i).place(),
                fmt::format("is row {} of {}", summary.pair_outliers[i].row, evidence.pairs.size()),
                remedy);
  }
  if (evidence.pairs.size() == 0) check_squares(summary, coordinates, node);
}

Json summary_json(const CalibrationSummary& s, const Rig& rig) {
  Json json{{"source", s.source}, {"pixel_sigma_px", s.pixel_sigma_px},
            {"rms_px", s.rms_px}, {"chi2", s.chi2},
            {"dof", s.dof},       {"views", s.views}};
  if (s.prior_dof > 0) {
    json["prior_chi2"] = s.prior_chi2;
    json["prior_dof"] = s.prior_dof;
  }
  if (s.effects) json["effects"] = effects_json(*s.effects);
  if (s.board_aspect) {
    json["board_aspect"] = {{"value", s.board_aspect->value}, {"sigma", s.board_aspect->sigma}};
  }
  if (!s.held.empty()) json["held"] = s.held;
  json["outliers"] = Json::array();
  for (const CornerOutlier& o : s.outliers) {
    json["outliers"].push_back({{"frame", o.frame},
                                {"camera", rig.cameras[o.camera].name},
                                {"corner", o.id},
                                {"image", o.image},
                                {"pixel_px", {o.pixel_px.x(), o.pixel_px.y()}},
                                {"residual_px", o.residual_px}});  // null if NaN
  }
  for (const PairOutlier& o : s.pair_outliers) {
    json["pair_outliers"].push_back(to_json(o));
  }
  json["warnings"] = s.warnings;
  if (!s.trust_warnings.empty()) json["doubts"] = s.trust_warnings;
  return json;
}

}  // namespace vernier::internal::rig_json
