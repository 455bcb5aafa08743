// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "calib/board/board_warp.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/calibration/outliers.h"
#include "calib/camera.h"
#include "calib/estimate/held_parameters.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/resolve.h"

namespace vernier::test {

using namespace vernier::internal;

inline constexpr double sigma_px = 0.2;

/// Two cameras of one model with enough views for every model.
SimulatedBoard scene(const Rig& rig, int frames = 24, double pixel_sigma_px = sigma_px);

/// Corners left out so that no two views have the same ones.
void make_partial(BoardObservations& observations);

/// χ² at a state, by the plain code, and the covariance of the rig there.
struct Reference {
  double chi2 = 0;
  double residuals = 0;
  Eigen::MatrixXd covariance;  ///< zero where held
  Eigen::VectorXd sd;          ///< infinite where held

  Reference(const BoardObservations& observations,
            const BoardState& state,
            const ReprojectionProblem& problem = {});
};

/// The last Newton step from a state to the minimum, in the rig's tangent, by the plain code's
/// normal equations. These know no weights: then none.
Eigen::VectorXd newton_step(const BoardObservations& observations,
                            const BoardState& state,
                            const ReprojectionProblem& problem);

/// The re-solver's answer from `start` is the minimum by the plain code, and Ceres' from the same
/// start. Ceres accepts no step that the rounding of the cost (1e-12 px²) hides, so it may stop
/// some 1e-6 standard deviations short, and 1e-2 along opencv8's valley: it is taken the last
/// Newton step before it is compared.
void expect_as_ceres(const BoardObservations& observations,
                     const BoardState& start,
                     const ReprojectionProblem& problem = {});

/// A start `sigmas` standard deviations away in every parameter, boards moved as well.
BoardState perturbed(const SimulatedBoard& board,
                     double sigmas,
                     const ReprojectionProblem& problem = {});

/// Corners of a board bent by `warp_m`.
SimulatedBoard bent(SimulatedBoard board, const Eigen::Vector2d& warp_m);

}  // namespace vernier::test
