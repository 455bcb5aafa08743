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
#include "calib/statistics/random.h"

namespace vernier::internal {

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
                          const BootstrapOptions& options,
                          bool is_scale) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (clusters < 3 || options.resamples < 1) return {nan, nan};
  std::vector<std::size_t> each(static_cast<std::size_t>(clusters));
  std::iota(each.begin(), each.end(), 0);
  const double value = statistic(each);
  const Interval drawn = bootstrap_interval(each.size(), statistic, options);
  if (!std::isfinite(value) || std::isnan(drawn.low)) return {nan, nan};
  const double few = student_quantile(0.975, clusters - 1) / normal_quantile(0.975) *
                     std::sqrt(clusters / (clusters - 1.0));
  if (is_scale && drawn.low > 0.5 * value && drawn.low > 0) {
    return {value * std::pow(std::min(1.0, value / drawn.high), few),
            value * std::pow(std::max(1.0, value / drawn.low), few)};
  }
  return {value - few * std::max(0.0, value - drawn.low),
          value + few * std::max(0.0, drawn.high - value)};
}

}  // namespace vernier::internal
