// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/success_interval.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/interval.h"
#include "calib/statistics/bootstrap.h"
#include "calib/statistics/cluster_interval.h"
#include "calib/statistics/distributions.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Trials of all maps, and how their successes are spread over the maps.
struct MapSpread {
  double trials = 0, successes = 0;
  int maps = 0;
  int with_success = 0, with_failure = 0;  ///< maps
  double design_effect = 0;                ///< as found, 0 if all trials end alike
};

MapSpread spread_over(std::span<const ClusterCount> maps) {
  MapSpread s;
  for (const ClusterCount& map : maps) {
    if (map.trials == 0) continue;
    s.trials += map.trials;
    s.successes += map.successes;
    ++s.maps;
    s.with_success += map.successes > 0;
    s.with_failure += map.successes < map.trials;
  }
  const double p = s.trials > 0 ? s.successes / s.trials : 0;
  const double binomial = s.trials * p * (1 - p);
  if (s.maps < 2 || !(binomial > 0)) return s;
  double between = 0;
  for (const ClusterCount& map : maps) {
    const double residual = map.successes - p * map.trials;
    between += residual * residual;
  }
  s.design_effect = between * s.maps / (s.maps - 1.0) / binomial;
  return s;
}

/// The design effect to reckon with (success_interval.h).
double cautious_design_effect(const MapSpread& s) {
  constexpr double least = 1.0 / 3;
  constexpr double usual_correlation = 0.15, enough_share = 0.8, enough_maps = 6;
  const double found = std::max(least, s.design_effect);
  const double usual = 1 + (s.trials / s.maps - 1) * usual_correlation;
  const double show = std::min(s.with_success, s.with_failure);
  const double weight =
      std::max(0.0, 1 - show / (enough_share * s.maps)) * enough_maps / (enough_maps + show);
  return found + weight * std::max(0.0, usual - found);
}

}  // namespace

std::optional<Interval> clustered_interval_95(std::span<const ClusterCount> maps) {
  const MapSpread s = spread_over(maps);
  if (s.maps < fewest_maps) return std::nullopt;
  const double t = student_quantile(0.975, s.maps - 1);
  const double p = s.successes / s.trials, m = s.trials / cautious_design_effect(s);
  const double shrink = 1 + t * t / m;
  const double centre = (p + t * t / (2 * m)) / shrink;
  const double half = t * std::sqrt(p * (1 - p) / m + t * t / (4 * m * m)) / shrink;
  // p lies within, also where rounding says otherwise
  return Interval{std::clamp(centre - half, 0.0, p), std::clamp(centre + half, p, 1.0)};
}

std::optional<Interval> interval_over_worlds_95(std::span<const ClusterCount> worlds) {
  static_assert(fewest_worlds >= fewest_maps);
  const auto count = static_cast<int>(worlds.size());
  const std::optional<Interval> cautious = clustered_interval_95(worlds);
  if (count < fewest_worlds || !cautious) return std::nullopt;
  const ClusterStatistic success = [&](std::span<const std::size_t> drawn) {
    double successes = 0, trials = 0;
    for (const std::size_t world : drawn) {
      successes += worlds[world].successes;
      trials += worlds[world].trials;
    }
    return successes / trials;
  };
  const Interval drawn = cluster_interval(count, success);
  return Interval{std::max(0.0, std::min(drawn.low, cautious->low)),
                  std::min(1.0, std::max(drawn.high, cautious->high))};
}

std::optional<double> paired_p_value(std::span<const MapDifference> maps) {
  const auto count = static_cast<int>(maps.size());
  if (count < fewest_maps) return std::nullopt;
  double difference = 0, discordant = 0, trials = 0;
  for (const MapDifference& map : maps) {
    difference += map.difference;
    discordant += map.discordant;
    trials += map.trials;
  }
  if (!(discordant > 0)) return 1.0;
  double between = 0;
  for (const MapDifference& map : maps) {
    const double residual = map.difference - map.trials * difference / trials;
    between += residual * residual;
  }
  between *= count / (count - 1.0);
  return fisher_survival(difference * difference / std::max(discordant, between), 1, count - 1);
}

}  // namespace vernier::sim::internal
