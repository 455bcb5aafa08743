// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/cluster_interval.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/draw_sources.h"
#include "calib/random.h"

namespace vernier {
namespace {

/// Linear between the two order statistics beside p.
double quantile(const std::vector<double>& sorted, double p) {
  const double at = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

double student_quantile(double p, int dof) {
  const double z = normal_quantile(p), n = dof, z2 = z * z;
  if (dof == 1) return std::tan(M_PI * (p - 0.5));
  if (dof == 2) return (2 * p - 1) * std::sqrt(2 / (4 * p * (1 - p)));
  const double g1 = z * (z2 + 1) / 4;
  const double g2 = z * ((5 * z2 + 16) * z2 + 3) / 96;
  const double g3 = z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / 384;
  const double g4 = z * ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / 92160;
  return z + g1 / n + g2 / (n * n) + g3 / (n * n * n) + g4 / (n * n * n * n);
}

Interval cluster_interval(int clusters,
                          const ClusterStatistic& statistic,
                          const ClusterIntervalOptions& options) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (clusters < 3) return {nan, nan};
  const double value = statistic(std::vector<int>(static_cast<std::size_t>(clusters), 1));
  std::vector<double> drawn;
  for (int r = 0; r < options.resamples; ++r) {
    Draws draws({.seed = options.seed,
                 .trial = static_cast<std::uint32_t>(r),
                 .source = static_cast<std::uint32_t>(DrawSource::resampling)});
    std::vector<int> times(static_cast<std::size_t>(clusters), 0);
    for (int k = 0; k < clusters; ++k) ++times[draws.below(static_cast<std::uint32_t>(clusters))];
    const double of_resample = statistic(times);
    if (std::isfinite(of_resample)) drawn.push_back(of_resample);
  }
  if (!std::isfinite(value) || drawn.empty()) return {nan, nan};
  std::sort(drawn.begin(), drawn.end());
  const double few = student_quantile(0.975, clusters - 1) / normal_quantile(0.975) *
                     std::sqrt(clusters / (clusters - 1.0));
  return {value - few * std::max(0.0, value - quantile(drawn, 0.025)),
          value + few * std::max(0.0, quantile(drawn, 0.975) - value)};
}

}  // namespace vernier
