// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/rig.h"
#include "calib/solver/refined_minimum.h"

namespace vernier::internal {

/// Whether a difference is worse than the worst so far. NaN is worse than any number.
inline bool is_worse(double difference, double worst) {
  return !std::isnan(worst) && !(difference <= worst);
}
inline double worse(double a, double b) { return is_worse(a, b) ? a : b; }

/// Difference between two solutions of one problem, in mrcal's parameters.
struct MrcalComparison {
  double max_parameter_diff_sigma = 0;  ///< |θ − θ_mrcal| over mrcal's standard deviation
  std::string worst_parameter;
  double max_covariance_diff = 0;  ///< |C_ij − C_mrcal,ij| / √(C_mrcal,ii C_mrcal,jj)
  std::string worst_covariance;
  double cost_relative_diff = 0;  ///< (ours − mrcal's) / mrcal's
};

/// Gates of the check (docs/calibration.md).
inline constexpr double parameter_gate_sigma = 1e-6;
inline constexpr double covariance_gate = 1e-7;
inline constexpr double projection_covariance_gate = 1e-6;

/// Converts our solution to mrcal's parameters (θ, G C Gᵀ) and compares. `pixel_sigma_px` scales
/// the standard deviations; normalised covariances do not depend on it.
MrcalComparison compare(const RefinedMinimum& ours,
                        const MrcalSolution& mrcals,
                        double pixel_sigma_px);

/// mrcal's solution of the same problem, and its difference from ours.
struct MrcalCheck {
  MrcalSolution solution;
  MrcalComparison comparison;
  /// Why mrcal was restarted, one standard deviation from our minimum; empty if it was not.
  std::string restarted;
};

/// Solves with mrcal from `start`, the same start as ours. If mrcal finds no minimum from there, or
/// another one (opencv8 has several), it is restarted near ours. Throws Error if mrcal is not built
/// in or cannot express the problem.
MrcalCheck check_against_mrcal(const BoardObservations& observations,
                               const BoardState& start,
                               const RefinedMinimum& ours,
                               double pixel_sigma_px,
                               const std::vector<bool>& held = {});

/// max |A_ij − B_ij| / √(B_ii B_jj) over the rows with B_ii > 0, and the two rows of the maximum.
/// NaN if an entry of either matrix is NaN.
struct CovarianceDifference {
  double largest = 0;
  int row = 0, column = 0;
};
CovarianceDifference normalised_difference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace vernier::internal
