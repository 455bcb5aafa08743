// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/solver/reprojection_problem.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// A calibration to check.
struct CheckedProblem {
  BoardObservations observations;  ///< without outliers
  BoardState start;                ///< initial value of all solvers
  BoardState state;                ///< the solution
  ReprojectionProblem problem;     ///< fixed parameters, priors, warp, σ
  Eigen::MatrixXd bound;           ///< its minimum variance bound, full size
};

/// Solves the same problem with mrcal and compares parameters, covariance, and projection and
/// triangulation uncertainty with ours, with tolerances; also reports both solve times.
CheckSection check_by_mrcal(const CheckedProblem& problem, Session& session);

/// Monte Carlo check: solves the calibration with simulated noise and compares the errors with the
/// covariance.
struct MonteCarloResult {
  int trials = 200, threads = 0;
  std::uint64_t seed = 1;
};
CheckSection check_by_monte_carlo(const CheckedProblem& problem, const MonteCarloResult& copies);

}  // namespace vernier::cli
