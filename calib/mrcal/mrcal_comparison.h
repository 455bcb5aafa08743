// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "calib/mrcal/mrcal_solver.h"

namespace vernier {

/// A calibration of ours as the comparison needs it.
struct CheckedCalibration {
  BoardState state;
  Eigen::MatrixXd unit_bound;  ///< minimum variance bound of the tangent at a noise of 1 px
  double cost_px2 = 0;         ///< Σ r²
};

/// Linearises at `state`. `held` has one entry a parameter; empty holds none. Throws Error where
/// the observations leave a direction free.
CheckedCalibration checked_calibration(const BoardObservations& observations,
                                       const BoardState& state,
                                       const std::vector<bool>& held = {});

/// How far two solutions of one problem are apart, in mrcal's parameters.
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

/// Converts ours to mrcal's parameters (θ, G C Gᵀ) and compares. `pixel_sigma_px` scales the
/// standard deviations; normalised covariances do not depend on it.
MrcalComparison compare(const CheckedCalibration& ours,
                        const MrcalSolution& mrcals,
                        double pixel_sigma_px);

/// max |A_ij − B_ij| / √(B_ii B_jj) over the rows whose B_ii is not zero; the two rows where it is.
struct CovarianceDifference {
  double largest = 0;
  int row = 0, column = 0;
};
CovarianceDifference normalised_difference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace vernier
