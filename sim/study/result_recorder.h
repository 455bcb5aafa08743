// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "sim/study/ceiling.h"
#include "sim/study/study.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/study/work_units.h"

namespace vernier::sim::internal {

/// Stores results as they come, in any order, and reports how far the study is. One call at a time.
class ResultRecorder {
 public:
  /// Keeps references to all.
  ResultRecorder(const StudyWork& work,
                 const MissingWork& missing,
                 const StudyRun& run,
                 StudyStore& store);

  /// Reports that nothing is done yet of the queries, or of the blocks.
  void begin_queries();
  void begin_blocks();
  /// So many more blocks will come than were missing at first.
  void expect_blocks(std::size_t further) { blocks_total_ += static_cast<int>(further); }
  /// Stores and reports. Blocks are committed on return, together; queries some hundred at a time.
  void add(std::vector<std::pair<WorkUnit, UnitResult>> results);
  /// Commits the queries that are not yet.
  void flush();

 private:
  void add_queries(int ceiling, const std::vector<std::pair<int, QueryCeiling>>& queries);

  const StudyWork& work_;
  const StudyRun& run_;
  StudyStore& store_;
  int blocks_done_ = 0, blocks_total_ = 0, queries_done_ = 0, queries_total_ = 0;
  int uncommitted_ = 0;
  std::map<int, QueryCeilings> of_query_;  // by ceiling, those not committed
};

}  // namespace vernier::sim::internal
