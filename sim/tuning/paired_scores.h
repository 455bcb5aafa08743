// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

namespace vernier::sim::internal {

/// Two candidates on the same trials, round by round: by how much the first is better, with a limit
/// that may be looked at after every round.
///
/// Of n rounds with n_k trials and the differences d_k = Σ (a - b) of scores in [0, 1], and
/// d = Σ d_k / Σ n_k,
///
///     upper limit = d + t √V / Σ n_k
///     V = max(2 + Σ (a - b)², n / (n - 1) Σ (d_k - n_k d)²)
///
/// The second variance is that between rounds, which share a recorded map; the first is that of
/// independent pairs (McNemar's for scores of 0 and 1), with 2 added for rates near 0. t is the
/// deviate of Student's distribution with n - 1 degrees of freedom that is as improbable (Wallace,
/// Annals of Mathematical Statistics 30, 1959) as the normal deviate
///
///     z = √(2 (1 + 1/n) log(1 + √(n + 1) / 2α))
///
/// a one-sided normal mixture with ρ = 1 (Robbins, Annals of Mathematical Statistics 41, 1970;
/// for estimated variances Waudby-Smith, Arbour, Sinha, Kennedy and Ramdas, Annals of Statistics
/// 52, 2024): the true difference exceeds any of the limits, whenever one looks, with a probability
/// of about α.
class PairedScores {
 public:
  /// One round: the scores of the same trials, in [0, 1]. Throws Error if the numbers differ.
  void add_round(std::span<const double> a, std::span<const double> b);

  int rounds() const { return static_cast<int>(rounds_.size()); }
  double trials() const { return trials_; }
  /// Mean difference; 0 without trials.
  double difference() const { return trials_ > 0 ? sum_ / trials_ : 0; }
  /// √V / Σ n_k: its standard deviation. 0 without trials.
  double sd() const;
  /// In [-1, 1]; 1 for fewer than two rounds. Throws Error for an α outside (0, 1/2).
  double upper_limit(double alpha) const;
  /// The same for any number of rounds where other pairs show how rounds vary: with
  /// V = D (2 + Σ (a - b)²), D the design effect and `dof` the degrees of freedom that it is known
  /// with.
  double upper_limit(double alpha, double design_effect, int dof) const;

  /// Variance between rounds and of independent trials, of the sum of differences: their ratio,
  /// over many pairs, is the design effect. Both 0 for fewer than two rounds.
  struct Variances {
    double between = 0, independent = 0;
  };
  Variances variances() const;

 private:
  struct Round {
    double difference, trials;
  };
  double variance() const { return std::max(2 + squares_, variances().between); }
  double limit(double alpha, double variance, int dof) const;

  std::vector<Round> rounds_;
  double trials_ = 0, sum_ = 0, squares_ = 0;
};

}  // namespace vernier::sim::internal
