// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "calib/interval.h"

namespace vernier::internal {

struct BootstrapOptions {
  int resamples = 10'000;
  double confidence = 0.95;
  std::uint64_t seed = 1;
};

/// A value computed from a resample of the clusters, given as indices in [0, clusters), possibly
/// repeated.
using ClusterStatistic = std::function<double(std::span<const std::size_t> clusters)>;

/// Percentile interval of a statistic under resampling of whole clusters with replacement (Efron
/// 1979; Davison and Hinkley, "Bootstrap Methods and their Application", 1997, sections 3.8 and
/// 5.3), for scenes, views or draws with correlated parts. NaN values are dropped. The interval is
/// too narrow for few clusters: for a mean at 95 %, by 17 % with eleven and by a half with four;
/// cluster_interval (calib/statistics/cluster_interval.h) corrects that. Both ends are NaN for
/// fewer than two clusters or no value. Throws Error for options out of bounds.
Interval bootstrap_interval(std::size_t clusters,
                            const ClusterStatistic& statistic,
                            const BootstrapOptions& options = {});

/// Several values of a resample.
using ClusterStatistics = std::function<std::vector<double>(std::span<const std::size_t> clusters)>;

/// The same for `count` values that are computed together: an interval each, of the same resamples.
std::vector<Interval> bootstrap_intervals(std::size_t clusters,
                                          std::size_t count,
                                          const ClusterStatistics& statistics,
                                          const BootstrapOptions& options = {});

}  // namespace vernier::internal
