// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/noise/board_tests.h"
#include "calib/noise/component_tests.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/solver/linearised_cost.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// Throws Error for options that random effects and the board's aspect leave no place for: a warp
/// (a shape contains it), a given pixel noise (it is one of the components), motion seen by one
/// camera.
void check_effects(const CalibrationOptions& options, std::size_t cameras);

bool has_effects(const CalibrationOptions& options);

/// Adds what an aspect a leaves open to the covariance of all parameters: the board may be as large
/// as was said along x, along y, or between, so that the rig's scale has the standard deviation
/// |a| / 2.
void add_scale_of_aspect(const Rig& rig, double aspect, Eigen::MatrixXd& covariance);

/// Stretches the target of the observations to the aspect of the usual cost's minimum, at which the
/// state then is. Returns the aspect.
double take_aspect(BoardObservations& observations,
                   const ReprojectionProblem& problem,
                   BoardState& state);

/// Moves state and linearised cost from the usual minimum to that with random effects and the
/// board's aspect (calib/noise/random_effects.h), which the target takes, and adds them to the
/// summary; a doubt if there is no such minimum.
void move_to_effects(const CalibrationOptions& options,
                     BoardObservations& observations,
                     const ReprojectionProblem& problem,
                     BoardState& state,
                     LinearisedCost& cost,
                     CalibrationSummary& summary);

/// Whether a calibration's corners show the shape of the board, and its motion between exposures:
/// likelihood ratio tests at 1 % (calib/noise/component_tests.h) of the restricted likelihood with
/// white noise, a smooth field, shape and motion; of few views a test at 0.5 % that the board is
/// not bent (calib/noise/board_tests.h), since they do not tell the variance of a shape. Of a board
/// that is flat and stands still, 1 % of the calibrations find either.
///
/// And that its spacings along x and y are as given, at 0.5 %, beside a bend: views tell an aspect
/// from fx and fy where the board is turned about its normal in some of them, and `aspect` holds
/// how well.
struct EffectsTest {
  std::optional<ComponentTest> shape;     ///< nothing where it was not tested
  std::optional<ComponentTest> motion;    ///< the same; one camera sees none
  std::optional<ComponentTest> isotropy;  ///< of the motion; the same
  std::optional<BoardTest> bend;          ///< of the board; of few views
  bool along_baseline = false;            ///< isotropy is rejected
  std::optional<AspectEstimate> aspect;   ///< as tested
  std::string not_tested;                 ///< why shape and motion were not; empty if they were

  double aspect_p_value() const;  ///< Wald's; 1 where it was not tested
  bool has_aspect() const;
  bool tells_aspect() const;  ///< to 0.05 %, a quarter of what printers do
  bool has_bend() const;
  bool has_shape() const;  ///< or a bend, which is a part of it
  bool has_motion() const;
};

/// The test of a calibration without effects. Of 4 to 7 views the bend alone is tested. Not of
/// fewer views, of boards of more than 150 points (it takes long), of doubtful calibrations (but
/// for a bent board), nor where the options leave effects no place.
EffectsTest test_effects(const RigEstimate& usual, const CalibrationOptions& options);

/// `usual`, a calibration of the observations without effects, with the aspect and those effects
/// that the test finds, which are then set in the options, as the test is. Effects are tested with
/// the aspect where it is found. `usual` itself, with a warning, where they
/// lead to no minimum.
RigEstimate with_found_effects(RigEstimate usual,
                               const BoardObservations& observations,
                               CalibrationOptions& options,
                               EffectsTest& test);

}  // namespace vernier::internal
