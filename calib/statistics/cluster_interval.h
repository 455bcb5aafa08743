// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/bootstrap.h"

namespace vernier::internal {

/// Interval at options.confidence of a statistic whose samples are correlated within clusters; 95 %
/// in the formulas. With K clusters the percentiles q of their bootstrap
/// (calib/statistics/bootstrap.h) are moved away from the value v by
///
///     v − f (v − q_0.025),  v + f (q_0.975 − v),   f = t_{K−1, 0.975} / z_0.975 √(K / (K − 1))
///
/// because few clusters scatter less about their own mean than about the truth. The error of a
/// standard deviation (`is_scale`) is multiplicative, and downwards for small samples, so its
/// interval is the reverse one of the logarithm,
///
///     v (v / q_0.975)^f,  v (v / q_0.025)^f
///
/// unless it is hardly different from 0 (q_0.025 < v / 2). NaN for fewer than three clusters, and
/// without resamples.
Interval cluster_interval(int clusters,
                          const ClusterStatistic& statistic,
                          const BootstrapOptions& options = {.resamples = 999},
                          bool is_scale = false);

/// The same for `count` values that are computed together, none of them a scale.
std::vector<Interval> cluster_intervals(int clusters,
                                        std::size_t count,
                                        const ClusterStatistics& statistics,
                                        const BootstrapOptions& options = {.resamples = 999});

}  // namespace vernier::internal
