// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::internal {

/// The terms of the unified cost other than the corners, and its free parameters.
struct ReprojectionProblem {
  double pixel_sigma_px = 1;     ///< weight of the corners relative to the priors
  std::vector<bool> held;        ///< one per parameter of the rig (held_mask); empty: all free
  std::vector<RigPrior> priors;  ///< each adds its χ²
  BoardWarp warp = BoardWarp::known;
  /// One weight in [0, 1] per corner of every view, in the order of the observations; empty: all 1.
  std::vector<std::vector<double>> corner_weights;
  PairObservations pairs;            ///< matched corners of any scene; empty: boards only
  std::vector<double> pair_weights;  ///< one per row, 0 or above; empty: all 1
  double pair_sigma_scale = 1;       ///< multiplies the stated noise of the pairs
  int max_iterations = 200;
  bool must_converge = true;  ///< if false, the state after the last iteration is accepted
};

/// Throws Error if flags, priors or weights do not match this rig and these corners, or the noise
/// is not positive.
void check_problem(const BoardObservations& observations,
                   const Rig& rig,
                   const ReprojectionProblem& problem);

}  // namespace vernier::internal
