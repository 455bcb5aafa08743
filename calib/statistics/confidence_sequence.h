// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "calib/interval.h"

namespace vernier::internal {

/// Confidence interval of the mean of values in [0, 1] that come one after the other, which holds
/// at all times together: with probability `confidence` no interval of the growing list ever leaves
/// the mean out, so one may stop whenever it is narrow enough.
///
/// The hedged capital of Waudby-Smith and Ramdas, "Estimating means of bounded random variables by
/// betting" (JRSS B 86, 2024, section 4.2): the means m against which neither
///
///     ½ Π (1 + min(λ_i, c / m) (x_i - m))   nor   ½ Π (1 - min(λ_i, c / (1 - m)) (x_i - m))
///
/// has reached 1 / α, with c = 0.9, λ_t = √(2 log(2 / α) / (σ²_{t-1} t log(1 + t))) and σ²_t the
/// mean of 0.03 and the squares (x_i - x̄_i)², x̄_i the mean of the first i (after their equations 26
/// to 29, with c = 1/2 and 1/4 in place of 0.03). Any λ_t made of the values before t is valid;
/// these suit means of tens of trials. Values need the same mean given those before them, and no
/// common distribution. [0, 1] without values. Throws Error for a value outside [0, 1] or a
/// confidence outside (0, 1).
Interval confidence_sequence(std::span<const double> values, double confidence = 0.95);

}  // namespace vernier::internal
