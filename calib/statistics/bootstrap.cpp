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
  if (options.resamples < 1 || !(options.confidence > 0 && options.confidence < 1)) {
    throw Error(
        "bootstrap",
        fmt::format("{} resamples at a confidence of {}", options.resamples, options.confidence),
        "give at least one, and a confidence between 0 and 1");
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (clusters < 2) return {nan, nan};
  std::vector<double> values;
  std::vector<std::size_t> drawn(clusters);
  for (int r = 0; r < options.resamples; ++r) {
    RandomStream draws({.seed = options.seed,
                        .trial = static_cast<std::uint32_t>(r),
                        .source = static_cast<std::uint32_t>(DrawSource::cluster_bootstrap)});
    for (std::size_t& cluster : drawn) {
      const auto at = static_cast<std::size_t>(draws.uniform() * static_cast<double>(clusters));
      cluster = std::min(at, clusters - 1);
    }
    const double value = statistic(drawn);
    if (!std::isnan(value)) values.push_back(value);
  }
  if (values.empty()) return {nan, nan};
  const double tail = 0.5 * (1 - options.confidence);
  return {quantile(values, tail, QuantileKind::linear),
          quantile(values, 1 - tail, QuantileKind::linear)};
}

}  // namespace vernier::internal
