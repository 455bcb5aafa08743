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

/// The minimum of the joint cost of boards, pairs and priors (calib/joint_calibration.h), and while
/// it is sought the state of the search.
struct JointMinimum {
  MergedBoards boards;
  std::vector<BoardTerm> terms;  // those merged
  ReprojectionProblem cost;
  PackedPairs packed;  // those of the cost
  BoardState state;
  Loss loss;                      // of the pairs at the minimum
  std::vector<double> residuals;  // of the pairs there, in their stated standard deviations
};

/// The minimum of the robust cost: Huber's loss, whose minimum is unique, leads Tukey's to its own.
/// The scale of the pairs' noise is `fixed_scale`, or where that is 0 comes from their residuals.
void minimise_robust(JointMinimum& joint, double fixed_scale);

/// Least squares, with the scale likewise.
void minimise_least_squares(JointMinimum& joint, double fixed_scale);

/// The equations of the boards at the state, in all parameters of the rig; a bend that is free is
/// common to them.
ReducedNormalEquations board_equations(const JointMinimum& joint);

/// Whether a pair does not count at the minimum.
bool is_outlier(const JointMinimum& joint, std::size_t row);

}  // namespace vernier::internal
