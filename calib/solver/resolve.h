// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

struct ResolveOptions {
  double tolerance_sigma = 1e-7;  ///< largest remaining error, in standard deviations of the rig
  int threads = 1;                ///< the result does not depend on it
};

enum class ResolveStatus {
  converged,
  iteration_limit,  ///< the state is the best one found
  singular,         ///< the observations leave a direction or a frame's pose undetermined
};

struct ResolveResult {
  BoardState state;
  double chi2 = 0;     ///< Σ (r / σ)², with the prior's term
  int iterations = 0;  ///< linearisations
  ResolveStatus status = ResolveStatus::singular;
  double error_left_sigma = 0;  ///< estimated distance of the rig from the minimum
};

/// Solves a board calibration repeatedly: with the cost of minimise_reprojection(), including
/// priors, held parameters and a free warp, for other pixels of the same corners (Monte Carlo) or
/// from another start.
///
/// Gauss–Newton with Levenberg–Marquardt damping if a step fails. Each view gives the normal
/// equations of (intrinsics, twist of T_camera_board, residual); the derivative with respect to the
/// board's pose is that by the camera's twist times a 6 x 6 adjoint; board poses are eliminated
/// frame by frame (docs/calibration.md, "Re-solving").
///
/// Stops when the length of the step in standard deviations, sqrt(δᵀ S δ) / σ̂, times its rate of
/// decrease is below tolerance_sigma. Thread-safe; bitwise the same result for any number of
/// threads.
class Resolver {
 public:
  /// `around` provides models, frames and, if it is known, the warp. Observations must be sorted by
  /// check_and_sort. Throws Error if they do not match the state, or the problem the rig.
  Resolver(const BoardObservations& observations,
           const BoardState& around,
           ReprojectionProblem problem = {},
           ResolveOptions options = {});

  /// With the observed pixels, from `around`.
  ResolveResult resolve() const;
  /// With other pixels, one column per corner in the order of the observations. Throws Error for
  /// pixels that are not finite or too few.
  ResolveResult resolve(const Eigen::Matrix2Xd& pixels_px) const;
  ResolveResult resolve(const Eigen::Matrix2Xd& pixels_px, const BoardState& start) const;

  /// The minimum variance bound at `state`, parameters x parameters, zero for held ones: the
  /// inverse of the reduced information, priors included, a free warp eliminated. Throws Error if
  /// it is singular.
  Eigen::MatrixXd covariance(const BoardState& state) const;

 private:
  struct Problem;
  std::shared_ptr<const Problem> problem_;
};

}  // namespace vernier::internal
