// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/cluster_interval.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/bootstrap.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"

namespace vernier::internal {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::size_t> each_once(int clusters) {
  std::vector<std::size_t> each(static_cast<std::size_t>(clusters));
  std::iota(each.begin(), each.end(), 0);
  return each;
}

/// The interval `drawn` by the bootstrap, with its ends moved away from the value.
Interval widened(
    const Interval& drawn, double value, int clusters, double confidence, bool is_scale) {
  if (!std::isfinite(value) || std::isnan(drawn.low)) return {nan, nan};
  const double upper = 0.5 + 0.5 * confidence;
  const double few = student_quantile(upper, clusters - 1) / normal_quantile(upper) *
                     std::sqrt(clusters / (clusters - 1.0));
  if (is_scale && drawn.low > 0.5 * value && drawn.low > 0) {
    return {value * std::pow(std::min(1.0, value / drawn.high), few),
            value * std::pow(std::max(1.0, value / drawn.low), few)};
  }
  return {value - few * std::max(0.0, value - drawn.low),
          value + few * std::max(0.0, drawn.high - value)};
}

}  // namespace

Interval cluster_interval(int clusters,
                          const ClusterStatistic& statistic,
                          const BootstrapOptions& options,
                          bool is_scale) {
  if (clusters < 3 || options.resamples < 1) return {nan, nan};
  const std::vector<std::size_t> each = each_once(clusters);
  const double value = statistic(each);
  const Interval drawn = bootstrap_interval(each.size(), statistic, options);
  return widened(drawn, value, clusters, options.confidence, is_scale);
}

std::vector<Interval> cluster_intervals(int clusters,
                                        std::size_t count,
                                        const ClusterStatistics& statistics,
                                        const BootstrapOptions& options) {
  std::vector<Interval> intervals(count, Interval{nan, nan});
  if (clusters < 3 || options.resamples < 1) return intervals;
  const std::vector<std::size_t> each = each_once(clusters);
  const std::vector<double> values = statistics(each);
  intervals = bootstrap_intervals(each.size(), count, statistics, options);
  for (std::size_t i = 0; i < count; ++i) {
    intervals[i] = widened(intervals[i], values.at(i), clusters, options.confidence, false);
  }
  return intervals;
}

}  // namespace vernier::internal
