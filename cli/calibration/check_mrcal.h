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

/// A calibration to be checked.
struct CheckedProblem {
  BoardObservations observations;  ///< without outliers
  BoardState start;                ///< where every solver starts
  BoardState state;                ///< what was calibrated
  ReprojectionProblem problem;     ///< held parameters, priors, warp, σ
  Eigen::MatrixXd bound;           ///< its minimum variance bound, full size
};

/// The same problem by mrcal: its parameters, covariance, projection and triangulation uncertainty
/// and solving time beside ours, against the gates.
CheckSection check_by_mrcal(const CheckedProblem& problem, const Session& session);

/// Noisy copies of the calibration, solved again: errors against the covariance.
struct MonteCarloResult {
  int trials = 200, threads = 0;
  std::uint64_t seed = 1;
};
CheckSection check_by_monte_carlo(const CheckedProblem& problem, const MonteCarloResult& copies);

}  // namespace vernier::cli
