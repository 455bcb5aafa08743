// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/bootstrap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/error.h"
#include "calib/interval.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/quantile.h"
#include "calib/statistics/random.h"

namespace vernier::internal {

Interval bootstrap_interval(std::size_t clusters,
                            const ClusterStatistic& statistic,
                            const BootstrapOptions& options) {
  const auto one = [&](std::span<const std::size_t> drawn) {
    return std::vector<double>{statistic(drawn)};
  };
  return bootstrap_intervals(clusters, 1, one, options)[0];
}

std::vector<Interval> bootstrap_intervals(std::size_t clusters,
                                          std::size_t count,
                                          const ClusterStatistics& statistics,
                                          const BootstrapOptions& options) {
  if (options.resamples < 1 || !(options.confidence > 0 && options.confidence < 1)) {
    throw Error(
        "bootstrap",
        fmt::format("{} resamples at a confidence of {}", options.resamples, options.confidence),
        "give at least one, and a confidence between 0 and 1");
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Interval> intervals(count, Interval{nan, nan});
  if (clusters < 2) return intervals;
  std::vector<std::vector<double>> values(count);
  std::vector<std::size_t> drawn(clusters);
  for (int r = 0; r < options.resamples; ++r) {
    RandomStream draws({.seed = options.seed,
                        .trial = static_cast<std::uint32_t>(r),
                        .source = static_cast<std::uint32_t>(DrawSource::cluster_bootstrap)});
    for (std::size_t& cluster : drawn) {
      const auto at = static_cast<std::size_t>(draws.uniform() * static_cast<double>(clusters));
      cluster = std::min(at, clusters - 1);
    }
    const std::vector<double> of_drawn = statistics(drawn);
    for (std::size_t i = 0; i < count; ++i) {
      if (!std::isnan(of_drawn.at(i))) values[i].push_back(of_drawn[i]);
    }
  }
  const double tail = 0.5 * (1 - options.confidence);
  for (std::size_t i = 0; i < count; ++i) {
    if (values[i].empty()) continue;
    intervals[i] = {quantile(values[i], tail, QuantileKind::linear),
                    quantile(values[i], 1 - tail, QuantileKind::linear)};
  }
  return intervals;
}

}  // namespace vernier::internal
