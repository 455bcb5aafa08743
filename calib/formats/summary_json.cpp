// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "calib/base/shown_text.h"
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

CornerOutlier parse_outlier(const Node& node, const Rig& rig) {
  CornerOutlier outlier;
  outlier.frame = node.at("frame").integer();
  outlier.camera = camera_index(node.at("camera"), rig);
  outlier.id = node.at("corner").integer();
  if (node.has("image")) outlier.image = node.at("image").text();
  const Eigen::VectorXd q = node.at("pixel_px").vector();
  if (q.size() != 2) throw Error(node.at("pixel_px").place(), "is not a pixel", "");
  outlier.pixel_px = q;
  outlier.residual_px = node.at("residual_px").json().is_null()
                            ? std::numeric_limits<double>::quiet_NaN()
                            : node.at("residual_px").number();
  return outlier;
}

/// Names of held parameters. Unknown names are rejected, since they would be freed silently.
std::vector<std::string> parse_held(const Node& node, const Rig& rig) {
  std::vector<std::string> held = parse_texts(node, "held");
  const std::vector<std::string> names = parameter_names(rig);
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (std::find(names.begin(), names.end(), held[i]) != names.end()) continue;
    throw Error(node.at("held").at(i).place(), "the rig has no parameter " + in_quotes(held[i]),
                "use a name from parameter_names");
  }
  return held;
}

/// A number that cannot be negative.
double not_negative(const Node& node) {
  const double value = node.number();
  if (value < 0) throw Error(node.place(), "is negative", "calibrate again");
  return value;
}

int count(const Node& node) {
  const int value = node.integer();
  if (value < 0) throw Error(node.place(), "is negative", "calibrate again");
  return value;
}

}  // namespace

CalibrationSummary parse_summary(const Node& node, const Rig& rig) {
  CalibrationSummary summary;
  summary.source = node.at("source").text();
  summary.pixel_sigma_px = not_negative(node.at("pixel_sigma_px"));
  summary.rms_px = not_negative(node.at("rms_px"));
  summary.chi2 = not_negative(node.at("chi2"));
  summary.dof = count(node.at("dof"));
  summary.views = count(node.at("views"));
  if (node.has("prior_chi2")) summary.prior_chi2 = not_negative(node.at("prior_chi2"));
  if (node.has("prior_dof")) summary.prior_dof = count(node.at("prior_dof"));
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

Json summary_json(const CalibrationSummary& s, const Rig& rig) {
  Json json{{"source", s.source}, {"pixel_sigma_px", s.pixel_sigma_px},
            {"rms_px", s.rms_px}, {"chi2", s.chi2},
            {"dof", s.dof},       {"views", s.views}};
  if (s.prior_dof > 0) {
    json["prior_chi2"] = s.prior_chi2;
    json["prior_dof"] = s.prior_dof;
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
