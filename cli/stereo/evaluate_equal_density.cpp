// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/evaluate_equal_density.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "cli/program/session.h"
#include "cli/stereo/evaluate_scene.h"
#include "stereo/evaluation/equal_density.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/matching/dense_matchers.h"

namespace vernier::cli {
namespace {

constexpr int curve_points = 20;

std::vector<CurvePoint> by_confidence(const Scene& scene,
                                      const Run& run,
                                      const EvaluationOptions& how) {
  return density_curve(scene.edges, run.found, scene.truth, scene.pair.left.width_px,
                       {.points = curve_points, .scored = how});
}

/// One point per matcher of a sweep, highest density first.
std::vector<CurvePoint> by_sweep(const Scene& scene,
                                 const std::vector<Matcher>& sweep,
                                 const EvaluationOptions& how) {
  std::vector<CurvePoint> curve;
  for (const Matcher& matcher : sweep) {
    const MatcherScore s =
        evaluate(scene.edges, matcher.match(scene.pair, scene.edges, scene.file.range), scene.truth,
                 scene.pair.left.width_px, how);
    CurvePoint point;
    point.density = s.all.density;
    point.bad_1 = s.all.bad_1;
    point.mismatch = s.mismatch;
    curve.push_back(point);
  }
  std::stable_sort(curve.begin(), curve.end(),
                   [](const CurvePoint& a, const CurvePoint& b) { return a.density > b.density; });
  return curve;
}

/// Pointwise means over the scenes.
Json mean_curve(const std::vector<const std::vector<CurvePoint>*>& curves) {
  std::size_t points = curves.front()->size();
  for (const auto* curve : curves) points = std::min(points, curve->size());
  Json mean = Json::array();
  const auto n = static_cast<double>(curves.size());
  for (std::size_t k = 0; k < points; ++k) {
    CurvePoint sum;
    for (const auto* curve : curves) {
      sum.density += (*curve)[k].density;
      sum.bad_1 += (*curve)[k].bad_1;
      sum.mismatch += (*curve)[k].mismatch;
    }
    mean.push_back({sum.density / n, sum.bad_1 / n, sum.mismatch / n});
  }
  return mean;
}

/// Whether rejecting matches of low confidence changes anything.
bool states_confidence(const std::vector<DensityCurves>& scenes) {
  return std::any_of(scenes.begin(), scenes.end(), [](const DensityCurves& scene) {
    return scene.peer.front().front().density != scene.peer.front().back().density;
  });
}

}  // namespace

EvaluationAtEqualDensity::EvaluationAtEqualDensity(const std::vector<Matcher>& matchers)
    : matchers_(matchers) {
  for (std::size_t m = 1; m < matchers.size(); ++m) {
    ComparedMatcher peer{matchers[m].name, {}, {}, {}, {}};
    if (peer.name == "sgbm") {
      for (const auto& [mode, words] :
           {std::pair{SgbmMode::three_ways, "3-way"}, std::pair{SgbmMode::five_paths, "5 paths"},
            std::pair{SgbmMode::eight_paths, "8 paths"}}) {
        for (const int block : {1, 3, 5}) {
          peer.settings.push_back(fmt::format("{}, block {}", words, block));
          peer.sweeps.push_back(by_uniqueness(SgbmOptions{.mode = mode, .block_px = block}));
        }
      }
    } else if (peer.name == "bm") {
      for (const int block : {7, 9, 13, 17}) {
        peer.settings.push_back(fmt::format("block {}", block));
        peer.sweeps.push_back(by_uniqueness(BmOptions{.block_px = block}));
      }
    } else {
      peer.settings.push_back("by confidence");
    }
    peers_.push_back(std::move(peer));
  }
}

void EvaluationAtEqualDensity::add(const Scene& scene,
                                   const std::vector<Run>& runs,
                                   const EvaluationOptions& how) {
  const std::vector<CurvePoint> own = by_confidence(scene, runs.front(), how);
  for (std::size_t p = 0; p < peers_.size(); ++p) {
    DensityCurves curves{own, {}};
    for (const auto& sweep : peers_[p].sweeps) curves.peer.push_back(by_sweep(scene, sweep, how));
    if (peers_[p].sweeps.empty()) curves.peer.push_back(by_confidence(scene, runs[p + 1], how));
    const bool something =
        !curves.own.empty() && std::none_of(curves.peer.begin(), curves.peer.end(),
                                            [](const auto& curve) { return curve.empty(); });
    if (something) {
      peers_[p].scenes.push_back(std::move(curves));
    } else {
      peers_[p].left_out.push_back(scene.file.name);
    }
  }
}

Json EvaluationAtEqualDensity::json() const {
  Json peers = Json::object();
  for (const ComparedMatcher& peer : peers_) {
    if (peer.scenes.empty()) continue;
    const EqualDensity e = at_equal_density(peer.scenes);
    const bool cut = !peer.sweeps.empty() || states_confidence(peer.scenes);
    peers[peer.name] = {
        {"setting", cut ? peer.settings[e.setting] : "unchanged: no confidence available"},
        {"scenes", peer.scenes.size()},
        {"left_out", peer.left_out},
        {"density", e.density},
        {"bad_1", e.own_bad_1},
        {"peer_bad_1", e.peer_bad_1},
        {"ratio", json_number(e.ratio)},
        {"ratio_interval_95", {json_number(e.interval.low), json_number(e.interval.high)}}};
  }
  return {{"matcher", matchers_.front().name}, {"against", peers}};
}

Json EvaluationAtEqualDensity::curves() const {
  Json curves = Json::object();
  for (const ComparedMatcher& peer : peers_) {
    if (peer.scenes.empty()) continue;
    const std::size_t setting = at_equal_density(peer.scenes, {.resamples = 1}).setting;
    std::vector<const std::vector<CurvePoint>*> own, others;
    for (const DensityCurves& scene : peer.scenes) {
      own.push_back(&scene.own);
      others.push_back(&scene.peer[setting]);
    }
    curves[matchers_.front().name] = mean_curve(own);
    curves[peer.name] = mean_curve(others);
  }
  return curves;
}

std::string EvaluationAtEqualDensity::text(const Json& json) {
  std::string text;
  for (const auto& [name, e] : json.at("against").items()) {
    text += fmt::format("at equal density {:.4f}: {} bad 1 {:.2f} %, {} ({}) {:.2f} %",
                        e.at("density").get<double>(), json.at("matcher").get<std::string>(),
                        100 * e.at("bad_1").get<double>(), name, e.at("setting").get<std::string>(),
                        100 * e.at("peer_bad_1").get<double>());
    if (e.at("ratio").is_number()) {
      text += fmt::format(", ratio {:.2f}", e.at("ratio").get<double>());
      const Json &low = e.at("ratio_interval_95")[0], &high = e.at("ratio_interval_95")[1];
      if (low.is_number()) {
        text += fmt::format(" (95 % over scenes: {:.2f} {})", low.get<double>(),
                            high.is_number() ? fmt::format("… {:.2f}", high.get<double>())
                                             : "or more: the other has no error in some scenes");
      }
    }
    if (!e.at("left_out").empty()) {
      text += fmt::format("; {} pairs excluded because one matcher finds nothing",
                          e.at("left_out").size());
    }
    text += "\n";
  }
  return text.empty() ? text : "\n" + text;
}

}  // namespace vernier::cli
