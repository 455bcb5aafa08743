// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/bootstrap.h"
#include "sim/interval.h"

namespace vernier {

/// 95 % interval of a figure whose samples are alike within clusters. With K clusters the
/// percentiles q of their bootstrap (calib/bootstrap.h) are drawn away from the figure v itself by
///
///     v − f (v − q_0.025),  v + f (q_0.975 − v),   f = t_{K−1, 0.975} / z_0.975 √(K / (K − 1))
///
/// because few clusters scatter less about their own mean than about the truth. Not a number for
/// fewer than three clusters, and without resamples.
Interval cluster_interval(int clusters,
                          const ClusterStatistic& statistic,
                          const BootstrapOptions& options = {.resamples = 999});

/// Quantile of Student's t for p in (0.5, 1), by the expansion about the normal one (Abramowitz and
/// Stegun 26.7.5); exact for one and two degrees of freedom, right to 1 % from three at p = 0.975.
double student_quantile(double p, int dof);

}  // namespace vernier
