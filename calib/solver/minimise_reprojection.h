// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/initial_rig.h"
#include "calib/normal_equations.h"
#include "calib/pair_observations.h"
#include "calib/rig_prior.h"

namespace vernier {

/// What stands in the unified cost beside the corners, and what of it is free.
struct ReprojectionProblem {
  double pixel_sigma_px = 1;     ///< weighs the corners against the priors
  std::vector<bool> held;        ///< one a parameter of the rig (held_mask); empty: all free
  std::vector<RigPrior> priors;  ///< each adds its χ²
  BoardWarp warp = BoardWarp::known;
  /// One weight in [0, 1] a corner of every view, in the order of the observations; empty: all 1.
  std::vector<std::vector<double>> corner_weights;
  PairObservations pairs;            ///< matched corners of any scene; none: a board alone
  std::vector<double> pair_weights;  ///< one a row, 0 or above; empty: all 1
  double pair_sigma_scale = 1;       ///< multiplies the noise that the pairs state
  int max_iterations = 200;
  bool must_converge = true;  ///< else the state after the last iteration will do
};

/// Throws Error where flags, priors or weights are not those of this rig and these corners, or the
/// noise is not positive.
void check_problem(const BoardObservations& observations,
                   const Rig& rig,
                   const ReprojectionProblem& problem);

/// Minimises the unified cost
///
///     χ²(a) = Σ priors + Σ_i w_i |r_i(a)|² / σ²
///
/// over the rig, one pose of the board a frame and, if free, the board's warp, by Ceres (dense
/// Schur, one analytic block a view). r is the reprojection residual of the board's corners and
/// the Sampson residual of matched pairs (calib/epipolar_formulas.h), which have σ of their own;
/// either may be absent. Returns the state at the minimum; throws Error where Ceres finds none, as
/// above, and for a camera without views or pairs unless each of its parameters is held or known by
/// a prior. Whether the views determine the rig is not asked (calib/linearised_cost.h).
///
/// Ceres warns of a linear solver's failure through glog, whatever its options; that is no fault of
/// the result. glog's threshold is one for the whole process and not to be changed while others
/// log, so this function leaves it alone. A program that wants silence sets FLAGS_minloglevel =
/// google::GLOG_FATAL before its threads start, as vernier does.
BoardState minimise_reprojection(const BoardObservations& observations,
                                 BoardState start,
                                 const ReprojectionProblem& problem = {});

}  // namespace vernier
