// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/solver/loss.h"
#include "calib/solver/normal_equations.h"

namespace vernier::internal {

/// The normal equations of the pairs at `rig`, one cluster per image pair, with residuals divided
/// by `sigma_scale`: scores Σ ρ'/2 J, and as information m Σ J Jᵀ over the pairs that count, m the
/// mean of ρ''/2 over them (Huber 1981, section 7.6). Second derivatives pair by pair need not be
/// positive definite if pairs are few.
ReducedNormalEquations pair_equations(const PairObservations& pairs,
                                      const Rig& rig,
                                      const Loss& loss,
                                      double sigma_scale);

/// Adds the terms and clusters of `more`; neither may contain a prior.
void add_equations(ReducedNormalEquations& equations, const ReducedNormalEquations& more);

/// The same pairs with every image pair split into `cells` x `cells` of the left image, each a
/// separate image pair.
PairObservations split_into_cells(const PairObservations& pairs,
                                  const Eigen::Vector2i& size_px,
                                  int cells = 4);

}  // namespace vernier::internal
