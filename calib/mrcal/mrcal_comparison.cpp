// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/mrcal/mrcal_comparison.h"

#include <Eigen/Core>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/mrcal/mrcal_parameters.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/rig.h"
#include "calib/solver/refined_minimum.h"

namespace vernier::internal {
namespace {

/// Relative; the costs at the same minimum agree to about 1e-13.
constexpr double same_minimum = 1e-9;

/// Our minimum moved by one standard deviation along each principal direction.
BoardState one_sigma_away(const RefinedMinimum& ours, double pixel_sigma_px) {
  const Eigen::VectorXd sd = ours.unit_bound.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = (sd.array() > 0).select(sd.cwiseInverse(), 0);
  const SymmetricEigen scaled(inverse.asDiagonal() * ours.unit_bound * inverse.asDiagonal());
  const Eigen::VectorXd lengths = scaled.eigenvalues().cwiseMax(0).cwiseSqrt();
  BoardState state = ours.state;
  state.rig =
      retract(state.rig, pixel_sigma_px * sd.asDiagonal() * scaled.eigenvectors() * lengths);
  return state;
}

}  // namespace

CovarianceDifference normalised_difference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  CovarianceDifference worst;
  for (Eigen::Index i = 0; i < B.rows(); ++i) {
    for (Eigen::Index j = 0; j < B.cols(); ++j) {
      const double apart = std::abs(A(i, j) - B(i, j)), scale = std::sqrt(B(i, i) * B(j, j));
      if (scale == 0 && !std::isnan(apart)) continue;
      if (is_worse(apart / scale, worst.largest)) {
        worst = {apart / scale, static_cast<int>(i), static_cast<int>(j)};
      }
    }
  }
  return worst;
}

MrcalComparison compare(const RefinedMinimum& ours,
                        const MrcalSolution& mrcals,
                        double pixel_sigma_px) {
  const std::vector<std::string> names = mrcal_parameter_names(ours.state.rig);
  const Eigen::VectorXd difference =
      mrcal_parameters(ours.state.rig) - mrcal_parameters(mrcals.state.rig);
  const Eigen::VectorXd sigma = pixel_sigma_px * mrcals.unit_covariance.diagonal().cwiseSqrt();
  MrcalComparison result;
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    if (sigma[i] == 0 && !std::isnan(difference[i])) continue;
    const double in_sigma = std::abs(difference[i]) / sigma[i];
    if (is_worse(in_sigma, result.max_parameter_diff_sigma)) {
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

MrcalCheck check_against_mrcal(const BoardObservations& observations,
                               const BoardState& start,
                               const RefinedMinimum& ours,
                               double pixel_sigma_px,
                               const std::vector<bool>& held) {
  const MrcalProblem expressible(observations,
                                 start);  // throws if mrcal cannot express the problem
  MrcalCheck check;
  try {
    check.solution = mrcal_solve(observations, start, held);
    check.comparison = compare(ours, check.solution, pixel_sigma_px);
    if (std::abs(check.comparison.cost_relative_diff) < same_minimum) return check;
    check.restarted = "mrcal ended in another minimum";
  } catch (const Error& error) {
    check.restarted = error.what();
  }
  const MrcalSolution first = std::move(check.solution);
  check.solution = mrcal_solve(observations, one_sigma_away(ours, pixel_sigma_px), held);
  check.comparison = compare(ours, check.solution, pixel_sigma_px);
  if (first.solve_cpu_ms > 0) {  // timed from the common start
    check.solution.solve_cpu_ms = first.solve_cpu_ms;
    check.solution.solve_wall_ms = first.solve_wall_ms;
  }
  return check;
}

}  // namespace vernier::internal
