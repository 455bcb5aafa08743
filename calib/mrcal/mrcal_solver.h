// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"

namespace vernier::internal {

/// A calibration solved by mrcal.
struct MrcalSolution {
  BoardState state;     ///< at the minimum of mrcal's cost
  double cost_px2 = 0;  ///< Σ r² there
  /// Of mrcal_parameters (calib/mrcal/mrcal_parameters.h), from mrcal's own Jacobian, for a noise
  /// of 1 px: S⁻¹ with the board poses eliminated. Zero for held parameters.
  Eigen::MatrixXd unit_covariance;
  /// mrcal_optimize alone, from the start, best of three runs. If single parameters are locked,
  /// which it cannot do, this is its solve of the whole lens model named here.
  std::string timed_lens;
  double solve_cpu_ms = 0, solve_wall_ms = 0;
  /// Distance of mrcal_optimize's result from the minimum: the last Gauss–Newton correction on
  /// mrcal's own residuals, in standard deviations at a noise of σ̂. 0 if it was not used.
  double stopped_short_sigma = 0;
};

/// Solves the problem with mrcal from the given start: same observations (an unobserved corner has
/// weight −1), same model, same cost; fixed board shape, no outlier rejection, no regularisation.
/// If all parameters of mrcal's lens model are free, mrcal_optimize solves it and Gauss–Newton
/// steps on mrcal's residuals and Jacobian refine the result to rounding; else (radial1, or
/// parameters in `held`, one entry per parameter of ours) Levenberg–Marquardt on those residuals
/// and that Jacobian times the columns of the free parameters. Throws Error if mrcal is not built
/// in, cannot express the problem or finds no minimum.
MrcalSolution mrcal_solve(const BoardObservations& observations,
                          const BoardState& start,
                          const std::vector<bool>& held = {});

/// mrcal_optimize alone, for benchmarks. Returns Σ r² at its result.
double mrcal_optimise_only(const BoardObservations& observations, const BoardState& start);

}  // namespace vernier::internal
