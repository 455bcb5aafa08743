// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/success_interval.h"

#include <algorithm>
#include <cmath>

#include "calib/interval.h"
#include "calib/statistics/distributions.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

std::optional<Interval> clustered_interval_95(std::span<const ClusterCount> maps) {
  double trials = 0, successes = 0;
  int count = 0;
  for (const ClusterCount& map : maps) {
    trials += map.trials;
    successes += map.successes;
    count += map.trials > 0;
  }
  if (count < fewest_maps) return std::nullopt;
  const double t = student_quantile(0.975, count - 1);
  const double p = successes / trials, m = trials / design_effect(maps);
  const double shrink = 1 + t * t / m;
  const double centre = (p + t * t / (2 * m)) / shrink;
  const double half = t * std::sqrt(p * (1 - p) / m + t * t / (4 * m * m)) / shrink;
  return Interval{std::max(0.0, centre - half), std::min(1.0, centre + half)};
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
