// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/race_search.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "calib/error.h"
#include "sim/experiment.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/tuning/objective.h"
#include "sim/tuning/race.h"
#include "sim/tuning/tune_settings.h"

namespace vernier::sim::internal {

namespace {

/// Trials of a block of any cell.
int trials_of(const StudyFile& study, int block) {
  return std::min(study.trials_per_block, study.trials - block * study.trials_per_block);
}

}  // namespace

RaceSearch::RaceSearch(const Study& study,
                       const std::vector<Candidate>& candidates,
                       const TuneSettings& settings)
    : study_(study),
      candidates_(candidates),
      settings_(settings),
      rounds_((study.file.trials + study.file.trials_per_block - 1) / study.file.trials_per_block),
      scores_(candidates.size()) {}

/// Adds the rounds that a candidate needs and has in all of its cells; returns whether any.
bool RaceSearch::read_rounds(int candidate, const StudyWork& work, const StoredResults& stored) {
  auto& scores = scores_[static_cast<std::size_t>(candidate)];
  const int first = static_cast<int>(scores.size());
  int end = state_.racers[static_cast<std::size_t>(candidate)].rounds;
  const std::vector<int>& cells = candidates_[static_cast<std::size_t>(candidate)].cells;
  for (const int cell : cells) {
    int there = first;
    while (there < end && stored.trials(work.cell_keys[static_cast<std::size_t>(cell)], there) >=
                              trials_of(study_.file, there)) {
      ++there;
    }
    end = there;
  }
  if (end <= first) return false;
  scores.resize(static_cast<std::size_t>(end));
  for (const int cell : cells) {
    const auto place = static_cast<std::size_t>(cell);
    for (const StoredBlock& block :
         blocks_of(study_.file.cells[place], {work.cell_keys[place], first, end}, stored)) {
      for (int i = 0; i < trials_of(study_.file, block.block); ++i) {
        scores[static_cast<std::size_t>(block.block)].push_back(
            score(settings_.objective, block.trials[static_cast<std::size_t>(i)]));
      }
    }
  }
  return true;
}

std::vector<int> RaceSearch::first_blocks(const StudyWork& work, const StoredResults& stored) {
  for (bool has_more = true; has_more;) {
    state_ = follow_race(scores_, rounds_, settings_.race);
    has_more = false;
    for (int i = 0; i < static_cast<int>(candidates_.size()); ++i) {
      has_more = read_rounds(i, work, stored) || has_more;
    }
  }
  std::vector<int> first(work.cell_keys.size(), 0);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    for (const int cell : candidates_[i].cells) {
      first[static_cast<std::size_t>(cell)] = state_.racers[i].rounds;
    }
  }
  return first;
}

RaceCost cost_of(const Study& study,
                 const std::vector<Candidate>& candidates,
                 const RaceState& state,
                 const StudyResults& results) {
  RaceCost cost;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const int trials =
        std::min(study.file.trials, state.racers[i].rounds * study.file.trials_per_block);
    for (const int cell : candidates[i].cells) {
      double cpu_ms = 0;
      for (const TrialResult& trial : results.cells[static_cast<std::size_t>(cell)].trials) {
        if (static_cast<int>(trial.trial) < trials) cpu_ms += trial.cpu_ms;
      }
      cost.trials += trials;
      cost.grid_trials += study.file.trials;
      cost.cpu_s += cpu_ms / 1000;
      if (trials > 0) cost.grid_cpu_s += cpu_ms / 1000 / trials * study.file.trials;
    }
  }
  return cost;
}

}  // namespace vernier::sim::internal
