// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "calib/interval.h"

namespace vernier::sim::internal {

/// Minimum number of recorded maps to estimate the variation between maps.
inline constexpr int fewest_maps = 6;

/// 95 % interval of a success rate p whose trials share maps: Wilson's interval with the effective
/// number of trials n / D and Student's quantile t_{K-1, 0.975} over the K maps,
///
///     (p + t²/2m ± t √(p (1 - p) / m + t²/4m²)) / (1 + t²/m),   m = n / D
///
/// Far from 0 and 1 it is Student's interval of the mean over maps. D is the design effect between
/// the maps, not less than 1/3 (t allows for one that is small by chance; 0 would be an interval of
/// no width). Where few maps show the rarer outcome, D is not known from them, and is moved towards
/// D0 = 1 + (n / K - 1) 0.15, that of maps whose trials have a correlation of 0.15:
///
///     D + w max(0, D0 - D),   w = max(0, 1 - f / 0.8 K) 6 / (6 + f)
///
/// with f maps that show it. nullopt for fewer than `fewest_maps` maps. How the constants were
/// chosen, and the coverage: docs/simulation.md.
std::optional<Interval> clustered_interval_95(std::span<const ClusterCount> maps);

/// Minimum number of worlds for an interval over worlds.
inline constexpr int fewest_worlds = 6;

/// 95 % interval of the success rate in worlds like these, from the counts in each: a bootstrap of
/// whole worlds, widened for few of them (calib/statistics/cluster_interval.h), and where failures
/// lie in few worlds the wider one of it and clustered_interval_95() with worlds in place of maps.
/// nullopt for fewer than `fewest_worlds` worlds.
std::optional<Interval> interval_over_worlds_95(std::span<const ClusterCount> worlds);

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
