// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sim/interval.h"

namespace vernier {

/// A figure of samples in clusters, each cluster taken so many times. Not a number where there is
/// nothing to take it from.
using ClusterStatistic = std::function<double(const std::vector<int>& times)>;

struct ClusterIntervalOptions {
  int resamples = 999;
  std::uint64_t seed = 1;
};

/// 95 % interval of a figure whose samples are alike within clusters: the bootstrap of whole
/// clusters (Davison and Hinkley, "Bootstrap Methods and their Application", 1997, 3.8). With K
/// clusters the percentiles q are drawn away from the figure v itself by
///
///     v − f (v − q_0.025),  v + f (q_0.975 − v),   f = t_{K−1, 0.975} / z_0.975 √(K / (K − 1))
///
/// because few clusters scatter less about their own mean than about the truth. Not a number for
/// fewer than three clusters.
Interval cluster_interval(int clusters,
                          const ClusterStatistic& statistic,
                          const ClusterIntervalOptions& options = {});

/// Quantile of Student's t for p in (0.5, 1), by the expansion about the normal one (Abramowitz and
/// Stegun 26.7.5); right to 1 % from two degrees of freedom at p = 0.975.
double student_quantile(double p, int dof);

}  // namespace vernier
