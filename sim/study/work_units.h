// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "sim/experiment.h"
#include "sim/study/ceiling.h"
#include "sim/study/store_rows.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_scenes.h"
#include "sim/study/study_work.h"
#include "sim/study/system_under_test.h"

namespace vernier::sim::internal {

/// A part of a study that one thread computes at a time: a block of trials, or some queries of a
/// ceiling.
struct WorkUnit {
  int block = -1;    ///< place in StudyWork::blocks; -1: queries
  int ceiling = -1;  ///< place in StudyWork::ceilings
  std::vector<int> queries = {};
};

/// What a unit gives.
struct UnitResult {
  BlockRow row;                                        ///< of a block
  std::vector<std::pair<int, QueryCeiling>> ceilings;  ///< of queries
};

/// The missing blocks of a study as units, one each.
std::vector<WorkUnit> block_units(const MissingWork& missing);

/// The missing queries, some a unit: few enough that all of many threads have a part.
std::vector<WorkUnit> query_units(const MissingWork& missing);

/// Computes units, from any thread. A result depends on the study and the unit only.
class UnitComputer {
 public:
  /// Keeps references to the study and its work. Throws Error if a cell cannot be run, or a program
  /// under test cannot.
  UnitComputer(const Study& study, const StudyWork& work, const std::stop_token& stop = {});

  /// What cells share.
  StudyScenes& scenes() { return scenes_; }

  /// Makes the views that maps are recorded from; needed before the first block.
  void prepare_maps();

  /// Of queries, those that are done when it is asked to stop.
  UnitResult compute(const WorkUnit& unit, const std::stop_token& stop) const;

  /// The trials of a block.
  std::vector<TrialResult> trials(const BlockJob& job) const;

 private:
  std::vector<TrialResult> localisations(const StudyCell& cell, const TrialBlock& trials) const;
  using Lease = std::unique_ptr<SystemUnderTest>;
  /// Throws Error at the line of the study that it is about.
  Lease system(const StudyCell& cell) const;
  /// One that nobody uses, or a new one: the programs and scenes of a cell serve many blocks.
  Lease lease(int cell) const;
  void give_back(int cell, Lease system) const;
  std::vector<TrialResult> trials_of_system(int cell, const TrialBlock& trials) const;
  /// Throws Error if a program fails in its first three trials, before hours are spent on it.
  void try_programs(const std::stop_token& stop) const;
  void try_program(const StudyCell& cell, const std::stop_token& stop) const;
  std::vector<std::pair<int, QueryCeiling>> queries(const WorkUnit& unit,
                                                    const std::stop_token& stop) const;
  /// Of the ceiling asked for last, kept.
  std::shared_ptr<const AliasFinder> finder(int ceiling) const;

  const Study& study_;
  const StudyWork& work_;
  mutable StudyScenes scenes_;
  std::map<std::string, std::shared_ptr<const MapViews>> looks_;
  mutable std::mutex finder_mutex_;
  mutable std::shared_ptr<const AliasFinder> finder_;
  mutable int finder_ceiling_ = -1;
  mutable std::mutex idle_mutex_;
  mutable std::deque<std::pair<int, Lease>> idle_;  // by cell, the oldest first
};

}  // namespace vernier::sim::internal
