// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/evaluate_figures.h"

#include <algorithm>
#include <cstddef>

#include "cli/program/session.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::cli {

Json figures_json(const MatcherScore& s, double time_ms) {
  const EdgeMetrics& f = s.all;
  if (f.matched == 0) {  // rates are undefined without matches
    Json none{{"density", 0.0}};
    for (const char* key : {"bad_0_5", "bad_1", "bad_2", "mismatch", "rms_inlier_px",
                            "bias_inlier_px", "bad_1_smooth", "bad_1_discontinuity"}) {
      none[key] = Json();
    }
    none["density_discontinuity"] = 0.0;
    none["occluded_matched"] = static_cast<double>(s.occluded_matched) / std::max(1, s.occluded);
    none["coverage_95"] = none["z_rms"] = Json();
    none["time_ms"] = time_ms;
    return none;
  }
  return {{"density", f.density},
          {"bad_0_5", f.bad_0_5},
          {"bad_1", f.bad_1},
          {"bad_2", f.bad_2},
          {"mismatch", s.mismatch},
          {"rms_inlier_px", s.smooth.rms_inlier_px},
          {"bias_inlier_px", s.smooth.bias_inlier_px},
          {"bad_1_smooth", s.smooth.bad_1},
          {"bad_1_discontinuity", s.discontinuity.bad_1},
          {"density_discontinuity", s.discontinuity.density},
          {"occluded_matched", static_cast<double>(s.occluded_matched) / std::max(1, s.occluded)},
          {"coverage_95", s.stated > 0 ? Json(s.coverage_95) : Json()},
          {"z_rms", s.stated > 0 ? Json(s.z_rms) : Json()},
          {"time_ms", time_ms}};
}

Json mean_of(const std::vector<Json>& scenes) {
  Json mean = scenes.front();
  for (auto& [key, value] : mean.items()) {
    double sum = 0;
    bool all = true;
    for (const Json& scene : scenes) {
      all = all && scene.at(key).is_number();
      if (all) sum += scene.at(key).get<double>();
    }
    value = all ? Json(sum / static_cast<double>(scenes.size())) : Json();
  }
  return mean;
}

Json angles_json(const MatcherScore& score) {
  Json bins = Json::array();
  for (std::size_t i = 0; i < score.by_angle.size(); ++i) {
    const EdgeMetrics& f = score.by_angle[i];
    bins.push_back({{"from_deg", 10 * i},
                    {"to_deg", 10 * (i + 1)},
                    {"edges", f.edges},
                    {"density", f.density},
                    {"bad_1", f.bad_1},
                    {"rms_inlier_px", f.rms_inlier_px}});
  }
  return bins;
}

std::string figures_header() {
  return fmt::format("{:<18} {:<10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>9} {:>9}\n",
                     "pair", "matcher", "density", "bad 0.5", "bad 1", "bad 2", "mismatch",
                     "rms px", "bias px", "bad 1 disc", "CPU ms");
}

std::string figures_line(const std::string& pair, const std::string& matcher, const Json& f) {
  const auto percent = [&](const char* key) {
    return f.at(key).is_null() ? "-" : fmt::format("{:.2f} %", 100 * f.at(key).get<double>());
  };
  const auto pixels = [&](const char* key) {
    return f.at(key).is_null() ? "-" : fmt::format("{:.3f}", f.at(key).get<double>());
  };
  return fmt::format("{:<18} {:<10} {:>8.4f} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>9} {:>9.1f}\n",
                     pair, matcher, f.at("density").get<double>(), percent("bad_0_5"),
                     percent("bad_1"), percent("bad_2"), percent("mismatch"),
                     pixels("rms_inlier_px"), pixels("bias_inlier_px"),
                     percent("bad_1_discontinuity"), f.at("time_ms").get<double>());
}

}  // namespace vernier::cli
