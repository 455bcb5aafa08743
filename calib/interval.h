// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace vernier {

/// From low to high; of a proportion that nothing is known of, [0, 1].
struct Interval {
  double low = 0, high = 1;

  bool operator==(const Interval&) const = default;
};

/// Wilson's score interval for a proportion (Wilson 1927). trials = 0 gives [0, 1]. `trials` need
/// not be whole: an effective number serves for clustered data. Throws Error unless
/// 0 <= successes <= trials and confidence is in (0, 1).
Interval wilson_interval(double successes, double trials, double confidence = 0.95);

/// Clopper and Pearson's interval for a proportion (1934): holds its confidence at least, whatever
/// the proportion. Throws Error unless 0 <= successes <= trials and confidence is in (0, 1).
Interval clopper_pearson_interval(int successes, int trials, double confidence = 0.95);

/// Successes and trials of one cluster: trials that share a map.
struct ClusterCount {
  int successes = 0, trials = 0;
};

/// How much the variance of a proportion grows by clustering, at least 1: the between-cluster
/// variance of the ratio estimate over the binomial one (Kish, "Survey Sampling", 1965). 1 for
/// fewer than two clusters.
double design_effect(std::span<const ClusterCount> clusters);

}  // namespace vernier
