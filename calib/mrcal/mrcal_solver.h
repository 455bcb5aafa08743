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
  BoardState state;     ///< where mrcal's cost is least
  double cost_px2 = 0;  ///< Σ r² there
  /// Of mrcal_parameters (calib/mrcal/mrcal_parameters.h), from mrcal's own Jacobian, for a noise
  /// of 1 px: S⁻¹ with the board poses eliminated. Zero where a parameter is held.
  Eigen::MatrixXd unit_covariance;
  /// mrcal_optimize alone, from the start, the best of three runs. Where parameters are locked one
  /// by one, which it cannot do, this is its solve of the whole lens model named here.
  std::string timed_lens;
  double solve_cpu_ms = 0, solve_wall_ms = 0;
  /// How far mrcal_optimize stopped from the minimum: the last correction by Gauss and Newton on
  /// mrcal's own residuals, in standard deviations at a noise of σ̂. 0 where it was not used.
  double stopped_short_sigma = 0;
};

/// Solves the problem by mrcal from the start given: same observations (a corner that was not seen
/// has weight −1), same model, same cost; the board keeps its shape, no outlier rejection, no
/// regularisation. Where all parameters of mrcal's lens are free, mrcal_optimize solves it and
/// Gauss–Newton steps on mrcal's residuals and Jacobian take its answer to rounding; else (radial1,
/// or parameters in `held`, one entry a parameter of ours) Levenberg–Marquardt on those residuals
/// and that Jacobian times the columns of the free parameters.
/// Throws Error where mrcal is not built in, cannot express the problem or finds no minimum.
MrcalSolution mrcal_solve(const BoardObservations& observations,
                          const BoardState& start,
                          const std::vector<bool>& held = {});

/// mrcal_optimize alone, as a benchmark wants it. Returns Σ r² where it stopped.
double mrcal_optimise_only(const BoardObservations& observations, const BoardState& start);

}  // namespace vernier::internal
