// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "localise/joined_lines.h"

namespace vernier::sim::internal {

/// Whether a line (z up) is upright as far as it is known: it leans by `most_rad` at most, and the
/// offset d = (b − a) on the floor plan agrees with none,
///
///     dᵀ S⁻¹ d ≤ −2 ln 0.0027 = 11.8,   S = J C Jᵀ, J = [−I, I] of x and y,
///
/// with its covariance C: three standard deviations, which one upright line in 370 exceeds by
/// chance (χ² with 2 degrees of freedom).
bool may_be_upright(const localise::JoinedLine& line, double most_rad);

}  // namespace vernier::sim::internal
