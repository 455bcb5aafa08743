// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "sim/experiment.h"

namespace vernier::sim::internal {

/// What a race seeks most of: the mean of a score in [0, 1] of each trial.
enum class Objective {
  success,         ///< 1 for an answer that errs by the cell's limit at most, else 0
  best_guess,      ///< the same where an unsure localiser's best guess counts too
  answered_right,  ///< 1 for a right answer, 1/2 for none, 0 for a wrong one
  error,           ///< 1 - min(error, limit) / limit; 0 without an answer
};

std::string_view name(Objective objective);
/// Throws Error for any other name.
Objective objective_named(std::string_view name);

double score(Objective objective, const TrialResult& trial);

}  // namespace vernier::sim::internal
