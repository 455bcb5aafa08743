// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/objective.h"

#include <algorithm>
#include <string>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/experiment.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

std::string_view name(Objective objective) {
  switch (objective) {
    case Objective::best_guess:
      return "best_guess";
    case Objective::answered_right:
      return "answered_right";
    case Objective::error:
      return "error";
    case Objective::success:
      break;
  }
  return "success";
}

Objective objective_named(std::string_view wanted) {
  for (const Objective objective :
       {Objective::success, Objective::best_guess, Objective::answered_right, Objective::error}) {
    if (name(objective) == wanted) return objective;
  }
  throw Error("objective " + in_quotes(std::string(wanted)), "is unknown",
              "use success, best_guess, answered_right or error");
}

double score(Objective objective, const TrialResult& trial) {
  switch (objective) {
    case Objective::best_guess:
      return trial.error <= trial.limit ? 1 : 0;
    case Objective::answered_right:
      return !trial.answered() ? 0.5 : trial.success() ? 1 : 0;
    case Objective::error:
      // written so that an error that is not a number counts as no answer
      return trial.success() ? 1 - std::min(trial.error, trial.limit) / trial.limit : 0;
    case Objective::success:
      break;
  }
  return trial.success() ? 1 : 0;
}

}  // namespace vernier::sim::internal
