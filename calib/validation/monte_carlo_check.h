// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/interval.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

struct MonteCarloOptions {
  int trials = 500;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: number of hardware threads; the result does not depend on it
};

/// Monte-Carlo test of the covariance C of a calibration with solved noisy copies. With δ_i the
/// error of copy i in the rig's tangent and q the rank of C, under the hypothesis that C is correct
///
///     NEES_i = δ_iᵀ C⁺ δ_i ~ χ²_q,     Σ W δ_i δ_iᵀ Wᵀ ~ Wishart(q, trials),   W C Wᵀ = I
struct MonteCarloCheck {
  int trials = 0;  ///< solved copies
  int failed = 0;  ///< copies that did not converge
  double nees_mean = 0;
  double nees_expected = 0;         ///< q
  Interval nees_interval_95{0, 0};  ///< of the mean, if C is correct
  Interval nees_interval_99{0, 0};
  std::vector<double> std_ratios;               ///< sampled over predicted; 0 for a held parameter
  double std_ratio_min = 0, std_ratio_max = 0;  ///< over the free parameters
  /// Smallest and largest eigenvalue of the sample covariance of W δ, and the 0.5 % quantile of the
  /// smallest and the 99.5 % quantile of the largest, simulated for a Wishart matrix of that size.
  std::array<double, 2> eigenvalues{};
  Interval eigenvalue_band_99{0, 0};
  double ks_p = 0;  ///< Kolmogorov and Smirnov: NEES against χ²_q
  double ks_p_components =
      0;  ///< the least of q tests of W δ against N(0, 1), times q (Bonferroni)

  /// At most 1 % of the copies failed. Failures are not a random subset.
  bool enough_trials_solved() const;
  /// The scatter is consistent with C: the mean NEES in its 99 % interval, the eigenvalues in their
  /// band, both ks_p above 0.005. A correct covariance fails in at most 3 % of checks.
  bool scatter_matches_covariance() const { return departures().empty(); }
  /// In words, each of these statistics that is not, with its band.
  std::vector<std::string> departures() const;
  bool consistent() const { return enough_trials_solved() && scatter_matches_covariance(); }
};

/// Throws Error for fewer trials than 2 q, q the rank of the covariance, and for q = 0.
void require_enough_trials(const Eigen::MatrixXd& covariance, int trials);

/// Solves copies of the calibration with predicted corners at `state` plus noise N(0, σ²), σ =
/// problem.pixel_sigma_px (over the square root of a corner's weight), each with the mean of every
/// prior drawn from that prior about state.rig. A view's noise is drawn by (trial, frame, camera).
/// `covariance` is full size, zero for held parameters. Copies are solved by Resolver from `state`.
/// Throws Error if the covariance has another size or fewer than 2 q copies can be solved. Fewer
/// trials than 2 q are refused before any is solved.
MonteCarloCheck monte_carlo_check(const BoardObservations& observations,
                                  const BoardState& state,
                                  const ReprojectionProblem& problem,
                                  const Eigen::MatrixXd& covariance,
                                  const MonteCarloOptions& options = {});

}  // namespace vernier::internal
