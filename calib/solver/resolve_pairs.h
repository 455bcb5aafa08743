// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/loss.h"
#include "calib/solver/packed_pairs.h"

namespace vernier::internal {

class PackedPairs;

/// The terms of the cost other than the pairs, and the loss of the pairs.
struct EpipolarProblem {
  std::vector<RigPrior> priors;
  std::vector<bool> held;  ///< one per parameter of the rig (held_mask); empty: all free
  double sigma_scale = 1;  ///< multiplies the stated noise of the pairs
  Loss loss;               ///< its limit in standard deviations, scaled
  int max_iterations = 100;
};

/// A minimum of the cost.
struct EpipolarMinimum {
  Rig rig;
  double cost = 0;        ///< Σ ρ(r) and the priors' χ²
  double prior_chi2 = 0;  ///< the priors' part
  int iterations = 0;
  bool converged = false;
};

/// Minimises the unified cost with the Sampson residual (Tina Memo 2017-001, Eq. 1),
///
///     χ²(a) = Σ priors + Σ_i ρ(r_i(a) / s)
///
/// by Gauss–Newton steps, weighted for a robust loss, damped if a step fails. Uses the kernels of
/// the reference solver (minimise_reprojection), against which it is tested; for solving many
/// times. Stops at a step below 1e-8 standard deviations.
class PairResolver {
 public:
  explicit PairResolver(const PairObservations& pairs);

  EpipolarMinimum minimise(const Rig& start, const EpipolarProblem& problem) const;

 private:
  std::shared_ptr<const PackedPairs> packed_;
};

}  // namespace vernier::internal
