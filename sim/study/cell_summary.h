// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calib/interval.h"

namespace vernier::sim::internal {

/// A quantity that a system measures, over the answered trials in which it is known.
struct MeasuredSummary {
  int trials = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double rms = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
};

/// The figures of a cell's trials.
struct CellSummary {
  int trials = 0;
  int maps = 0;  ///< number of recorded maps
  double success = 0;
  /// Clustered by map (success_interval.h); where the study stops by its width, the one that may be
  /// looked at at any time (budget.h).
  std::optional<Interval> success_interval_95;
  std::string why_no_interval;            ///< "needs 6 maps, has 1"; empty if there is an interval
  Interval success_interval_binomial_95;  ///< Wilson, as if trials were independent
  double coverage = 0;                    ///< fraction answered
  double success_when_answered = std::numeric_limits<double>::quiet_NaN();  ///< without an answer
  double best_guess_success = 0;  ///< where an unsure localiser's best guess counts too
  int failed = 0;                 ///< trials in which the system itself failed
  std::string why_failed;         ///< the first one's reason, where it is stored
  int unseen = 0;                 ///< trials in which a localiser saw too little to begin
  int unsure = 0;           ///< trials of other systems than localisers that doubt their answer
  std::string why_unsure;   ///< the first one's reason, if it says one
  double node_success = 0;  ///< for the map node instead of the refined pose
  double recall_05 = 0, recall_025 = 0;  ///< 0.5 m and 5°, 0.25 m and 2°
  double median_error = 0;               ///< over answered trials, in the unit of the system
  double p95_error = 0;                  ///< the same
  double median_heading_error_rad = 0;
  std::vector<MeasuredSummary> measured;  ///< of other systems than localisers, by their names
  double cpu_ms_mean = 0, cpu_ms_median = 0, cpu_ms_p95 = 0, wall_ms_mean = 0;
};

}  // namespace vernier::sim::internal
