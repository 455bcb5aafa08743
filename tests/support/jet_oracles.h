// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"

namespace vernier::test {

// Minima by Ceres' automatic differentiation of formulas written plainly: they share nothing with
// the kernels. Of `radial1` pairs, with a diagonal prior.

/// Minimum of the unified cost with the Sampson residual, from `start`, where the prior's mean
/// stands too.
Rig solve_by_jets(const PairObservations& pairs, const RigPrior& prior, const Rig& start);

/// Bundle adjustment of rig and points with the prior.
Rig bundle_adjusted(const PairObservations& pairs, const RigPrior& prior, const Rig& start);

}  // namespace vernier::test
