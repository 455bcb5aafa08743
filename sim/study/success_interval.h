// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "calib/interval.h"

namespace vernier::sim::internal {

/// Minimum number of recorded maps to estimate the variation between maps.
inline constexpr int fewest_maps = 6;

/// 95 % interval of a success rate whose trials share maps: Wilson's interval with the effective
/// number of trials n / D, D the design effect between the K maps, and Student's quantile t_{K-1,
/// 0.975} in place of the normal one, because D itself is estimated from K maps,
///
///     (p + t²/2m ± t √(p (1 - p) / m + t²/4m²)) / (1 + t²/m),   m = n / D
///
/// nullopt for fewer than `fewest_maps` maps. Coverage: docs/simulation.md.
std::optional<Interval> clustered_interval_95(std::span<const ClusterCount> maps);

/// Outcome of the trials of one map in two cells.
struct MapDifference {
  /// Trials in which only the first cell succeeded, minus those in which only the second did.
  int difference = 0;
  int discordant = 0;  ///< the sum of these two counts
  int trials = 0;
};

/// Two-sided p-value of the null hypothesis that neither cell is better, from the differences d of
/// K maps, by Student's t with K - 1 degrees of freedom,
///
///     t = Σ d / √max(c, K / (K - 1) Σ (d_k - n_k Σ d / Σ n)²)
///
/// with n_k trials in map k and c discordant trials in total. c is the variance in McNemar's test,
/// so this test is never sharper than that for independent trials. 1 without discordant trials;
/// nullopt for fewer than `fewest_maps` maps.
std::optional<double> paired_p_value(std::span<const MapDifference> maps);

}  // namespace vernier::sim::internal
