// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/interval.h"
#include "sim/study/study.h"
#include "sim/tuning/objective.h"

namespace vernier::sim::internal {

/// What cells of a candidate show together.
struct CandidateFigures {
  int trials = 0, maps = 0, worlds = 0;
  double score = 0;    ///< mean of the objective
  double success = 0;  ///< 0 without trials
  /// For further worlds like these if there are enough (success_interval.h), else for further maps
  /// of the same worlds; none for too few of both.
  std::optional<Interval> success_interval_95;
  bool over_worlds = false;  ///< which of the two
  double cpu_s = 0;          ///< of attempts to localise
};

/// Of the first `blocks` of some cells, by their places; all blocks if negative.
CandidateFigures figures_of(const StudyResults& results,
                            const std::vector<int>& cells,
                            Objective objective,
                            int blocks = -1);

/// By how much the mean score of one study's cells exceeds that of another's on the same trials:
/// two studies of the same worlds, conditions and seed, cell by cell. Where the settings move the
/// queries too, pairs are less alike and the interval is wider.
struct ConfirmedDifference {
  double difference = 0;
  /// Student's for further maps of these worlds, as the p-value of no difference: over recorded
  /// maps, which all conditions of a world share, with the variance V of paired_scores.h in each
  /// world; none for fewer than six maps.
  std::optional<Interval> interval_95;
  std::optional<double> p_value;
};

/// Throws Error if the studies have other numbers of cells or trials.
ConfirmedDifference confirmed_difference(const StudyResults& a,
                                         const StudyResults& b,
                                         Objective objective);

}  // namespace vernier::sim::internal
