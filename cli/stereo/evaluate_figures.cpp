// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/evaluate_figures.h"

#include <algorithm>
#include <cstddef>

#include "cli/program/session.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::cli {

namespace {

/// Null where there is nothing of which it would be a rate.
Json rate(double value, int of) { return of > 0 ? Json(value) : Json(); }

}  // namespace

Json figures_json(const MatcherScore& s, double time_ms) {
  const EdgeMetrics &all = s.all, &smooth = s.smooth, &discontinuity = s.discontinuity;
  return {{"density", all.density},
          {"bad_0_5", rate(all.bad_0_5, all.matched)},
          {"bad_1", rate(all.bad_1, all.matched)},
          {"bad_2", rate(all.bad_2, all.matched)},
          {"mismatch", rate(s.mismatch, all.matched)},
          {"rms_inlier_px", rate(smooth.rms_inlier_px, smooth.inliers)},
          {"bias_inlier_px", rate(smooth.bias_inlier_px, smooth.inliers)},
          {"bad_1_smooth", rate(smooth.bad_1, smooth.matched)},
          {"bad_1_discontinuity", rate(discontinuity.bad_1, discontinuity.matched)},
          {"density_discontinuity", rate(discontinuity.density, discontinuity.edges)},
          {"occluded_matched",
           rate(static_cast<double>(s.occluded_matched) / std::max(1, s.occluded), s.occluded)},
          {"coverage_95", rate(s.coverage_95, s.stated)},
          {"z_rms", rate(s.z_rms, s.stated)},
          {"time_ms", time_ms}};
}

Json mean_of(const std::vector<Json>& scenes) {
  const bool all_match = std::none_of(
      scenes.begin(), scenes.end(), [](const Json& scene) { return scene.at("bad_1").is_null(); });
  Json mean = scenes.front();
  for (auto& [key, value] : mean.items()) {
    double sum = 0;
    int count = 0;
    for (const Json& scene : scenes) {
      if (!scene.at(key).is_number()) continue;
      sum += scene.at(key).get<double>();
      ++count;
    }
    const bool all = count == static_cast<int>(scenes.size());
    value = rate(sum / std::max(1, count), all || all_match ? count : 0);
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
                    {"bad_1", rate(f.bad_1, f.matched)},
                    {"rms_inlier_px", rate(f.rms_inlier_px, f.inliers)}});
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
