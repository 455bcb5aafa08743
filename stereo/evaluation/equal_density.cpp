// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/equal_density.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "calib/error.h"
#include "calib/interval.h"
#include "calib/statistics/bootstrap.h"
#include "calib/statistics/cluster_interval.h"
#include "stereo/matcher_evaluation.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

/// One scene and setting.
struct Pair {
  double density = 0, own = 0, peer = 0;
};

Pair compare(const std::vector<CurvePoint>& own, const std::vector<CurvePoint>& peer) {
  const double density = std::min(own.front().density, peer.front().density);
  return {density, bad_1_at(own, density), bad_1_at(peer, density)};
}

void check(const std::vector<DensityCurves>& scenes) {
  const auto is_bad = [&](const DensityCurves& scene) {
    return scene.own.empty() || scene.peer.empty() ||
           scene.peer.size() != scenes.front().peer.size() ||
           std::any_of(scene.peer.begin(), scene.peer.end(),
                       [](const auto& curve) { return curve.empty(); });
  };
  if (!scenes.empty() && std::none_of(scenes.begin(), scenes.end(), is_bad)) return;
  throw Error("equal density", "no scenes, or a scene without curves",
              "give one curve per matcher and setting for every scene");
}

Pair mean_of(const std::vector<std::vector<Pair>>& pairs,
             std::size_t setting,
             std::span<const std::size_t> scenes) {
  Pair mean;
  for (const std::size_t s : scenes) {
    mean.density += pairs[s][setting].density;
    mean.own += pairs[s][setting].own;
    mean.peer += pairs[s][setting].peer;
  }
  const auto n = static_cast<double>(scenes.size());
  return {mean.density / n, mean.own / n, mean.peer / n};
}

/// NaN if both are 0.
double ratio_of(const Pair& pair) { return pair.own / pair.peer; }

/// The setting with the largest ratio.
std::size_t best_setting(const std::vector<std::vector<Pair>>& pairs,
                         std::span<const std::size_t> scenes) {
  std::size_t best = 0;
  double most = -1;
  for (std::size_t k = 0; k < pairs.front().size(); ++k) {
    const double ratio = ratio_of(mean_of(pairs, k, scenes));
    if (ratio > most) most = ratio, best = k;
  }
  return best;
}

}  // namespace

EqualDensity at_equal_density(const std::vector<DensityCurves>& scenes,
                              const BootstrapOptions& options) {
  check(scenes);
  std::vector<std::vector<Pair>> pairs;
  for (const DensityCurves& scene : scenes) {
    pairs.emplace_back();
    for (const auto& peer : scene.peer) pairs.back().push_back(compare(scene.own, peer));
  }
  std::vector<std::size_t> each(scenes.size());
  std::iota(each.begin(), each.end(), 0);
  EqualDensity result;
  result.setting = best_setting(pairs, each);
  const Pair mean = mean_of(pairs, result.setting, each);
  result.density = mean.density;
  result.own_bad_1 = mean.own;
  result.peer_bad_1 = mean.peer;
  result.ratio = ratio_of(mean);
  // A ratio is not below 0, and scatters as much by a factor upwards as downwards.
  const Interval of_log = cluster_interval(
      static_cast<int>(scenes.size()),
      [&](std::span<const std::size_t> drawn) {
        return std::log(ratio_of(mean_of(pairs, best_setting(pairs, drawn), drawn)));
      },
      options);
  result.interval = {std::exp(of_log.low), std::exp(of_log.high)};
  return result;
}

}  // namespace vernier::stereo::internal
