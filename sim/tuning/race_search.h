// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_work.h"
#include "sim/tuning/race.h"
#include "sim/tuning/tune_settings.h"

namespace vernier::sim::internal {

/// A race over the cells of a study. A round is a block of each of a candidate's cells; which
/// blocks are computed next is decided by those stored, in their order, so that the store of an
/// interrupted race, or of the whole study, goes on to the same end.
class RaceSearch {
 public:
  /// Keeps references to all.
  RaceSearch(const Study& study,
             const std::vector<Candidate>& candidates,
             const TuneSettings& settings);

  /// StudyRun::first_blocks: follows the race as far as there are blocks.
  std::vector<int> first_blocks(const StudyWork& work, const StoredResults& stored);

  /// As far as first_blocks() has followed it.
  const RaceState& state() const { return state_; }
  const RaceScores& scores() const { return scores_; }
  int rounds() const { return rounds_; }

 private:
  bool read_rounds(int candidate, const StudyWork& work, const StoredResults& stored);

  const Study& study_;
  const std::vector<Candidate>& candidates_;
  const TuneSettings& settings_;
  int rounds_;
  RaceState state_;
  RaceScores scores_;
};

/// Trials that a race took, and those of the study without it, of all candidates.
struct RaceCost {
  std::int64_t trials = 0, grid_trials = 0;
  /// Of attempts to localise, from features in memory to the answer; that of the grid by the mean
  /// of each candidate.
  double cpu_s = 0, grid_cpu_s = 0;
};
RaceCost cost_of(const Study& study,
                 const std::vector<Candidate>& candidates,
                 const RaceState& state,
                 const StudyResults& results);

}  // namespace vernier::sim::internal
