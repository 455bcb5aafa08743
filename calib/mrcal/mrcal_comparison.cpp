// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/mrcal_comparison.h"

#include <cmath>

#include "calib/covariance.h"
#include "calib/mrcal/mrcal_parameters.h"

namespace vernier {
namespace {

/// The bound with zeros where a parameter is held.
Eigen::MatrixXd bound_of(ReducedNormalEquations equations,
                         const std::vector<std::string>& names,
                         const std::vector<bool>& held) {
  std::vector<int> free;
  std::vector<std::string> free_names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i < held.size() && held[i]) continue;
    free.push_back(static_cast<int>(i));
    free_names.push_back(names[i]);
  }
  equations.information = equations.information(free, free).eval();
  equations.held_poses_diagonal = equations.held_poses_diagonal(free).eval();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(names.size(), names.size());
  all(free, free) = minimum_variance_bound(equations, free_names);
  return all;
}

}  // namespace

CheckedCalibration checked_calibration(const BoardObservations& observations,
                                       const BoardState& state,
                                       const std::vector<bool>& held) {
  const ReducedNormalEquations equations = reduced_normal_equations(observations, state, 1.0);
  return {state, bound_of(equations, parameter_names(state.rig), held), equations.chi2};
}

CovarianceDifference normalised_difference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  CovarianceDifference worst;
  for (Eigen::Index i = 0; i < B.rows(); ++i) {
    for (Eigen::Index j = 0; j < B.cols(); ++j) {
      const double scale = std::sqrt(B(i, i) * B(j, j));
      if (!(scale > 0)) continue;
      const double difference = std::abs(A(i, j) - B(i, j)) / scale;
      if (!(difference <= worst.largest)) {  // not a number is the worst of all
        worst = {difference, static_cast<int>(i), static_cast<int>(j)};
      }
    }
  }
  return worst;
}

MrcalComparison compare(const CheckedCalibration& ours,
                        const MrcalSolution& mrcals,
                        double pixel_sigma_px) {
  const std::vector<std::string> names = mrcal_parameter_names(ours.state.rig);
  const Eigen::VectorXd difference =
      mrcal_parameters(ours.state.rig) - mrcal_parameters(mrcals.state.rig);
  const Eigen::VectorXd sigma = pixel_sigma_px * mrcals.unit_covariance.diagonal().cwiseSqrt();
  MrcalComparison result;
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    if (!(sigma[i] > 0)) continue;
    const double in_sigma = std::abs(difference[i]) / sigma[i];
    if (!(in_sigma <= result.max_parameter_diff_sigma)) {
      result.max_parameter_diff_sigma = in_sigma;
      result.worst_parameter = names[i];
    }
  }
  const Eigen::MatrixXd G = mrcal_by_tangent(ours.state.rig);
  const CovarianceDifference covariance =
      normalised_difference(G * ours.unit_bound * G.transpose(), mrcals.unit_covariance);
  result.max_covariance_diff = covariance.largest;
  result.worst_covariance = names[covariance.row] + ", " + names[covariance.column];
  result.cost_relative_diff = (ours.cost_px2 - mrcals.cost_px2) / mrcals.cost_px2;
  return result;
}

}  // namespace vernier
