// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calib/board_state.h"
#include "calib/calibration/merged_boards.h"
#include "calib/joint_calibration.h"
#include "calib/solver/loss.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/packed_pairs.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

/// The minimum of the joint cost of boards, pairs and priors (calib/joint_calibration.h), and the
/// state of the search for it.
struct JointMinimum {
  MergedBoards boards;
  std::vector<BoardTerm> terms;  // those merged
  ReprojectionProblem cost;
  PackedPairs packed;  // those of the cost
  BoardState state;
  Loss loss;                      // of the pairs at the minimum
  std::vector<double> residuals;  // of the pairs there, in their stated standard deviations
};

/// Minimises the robust cost: Huber's loss, whose minimum is unique, gives the start for Tukey's.
/// The scale of the pairs' noise is `fixed_scale`, or is estimated from the residuals if that is 0.
void minimise_robust(JointMinimum& joint, double fixed_scale);

/// Least squares, with the scale as above.
void minimise_least_squares(JointMinimum& joint, double fixed_scale);

/// The equations of the boards at the state, in all parameters of the rig; a free warp is shared by
/// all of them.
ReducedNormalEquations board_equations(const JointMinimum& joint);

/// Whether a pair has no weight at the minimum.
bool is_outlier(const JointMinimum& joint, std::size_t row);

}  // namespace vernier::internal
