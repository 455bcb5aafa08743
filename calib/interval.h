// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace vernier {

/// An interval [low, high]; [0, 1] for a proportion without data.
struct Interval {
  double low = 0, high = 1;

  bool operator==(const Interval&) const = default;
};

/// Wilson's score interval for a proportion (Wilson 1927). trials = 0 gives [0, 1]. `trials` need
/// not be whole: an effective number serves for clustered data. Throws Error unless
/// 0 <= successes <= trials and confidence is in (0, 1).
Interval wilson_interval(double successes, double trials, double confidence = 0.95);

/// Clopper–Pearson interval for a proportion (1934): its coverage is at least its confidence for
/// every proportion. Throws Error unless 0 <= successes <= trials and confidence is in (0, 1).
Interval clopper_pearson_interval(int successes, int trials, double confidence = 0.95);

/// Successes and trials of one cluster: trials with a common map.
struct ClusterCount {
  int successes = 0, trials = 0;
};

/// Factor by which clustering increases the variance of a proportion, at least 1: the
/// between-cluster variance of the ratio estimate over the binomial one (Kish, "Survey Sampling",
/// 1965). 1 for fewer than two clusters. Throws Error unless 0 <= successes <= trials in each.
double design_effect(std::span<const ClusterCount> clusters);

}  // namespace vernier
