// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/result_recorder.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "sim/study/ceiling.h"
#include "sim/study/store_rows.h"
#include "sim/study/study.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/study/work_units.h"

namespace vernier::sim::internal {

ResultRecorder::ResultRecorder(const StudyWork& work,
                               const MissingWork& missing,
                               const StudyRun& run,
                               StudyStore& store)
    : work_(work),
      run_(run),
      store_(store),
      blocks_total_(static_cast<int>(missing.blocks.size())) {
  for (const std::vector<int>& of : missing.queries) queries_total_ += static_cast<int>(of.size());
}

void ResultRecorder::begin_queries() {
  if (run_.ceiling_progress) run_.ceiling_progress(0, queries_total_);
}

void ResultRecorder::begin_blocks() {
  if (run_.progress) run_.progress(0, blocks_total_);
}

void ResultRecorder::add(std::vector<std::pair<WorkUnit, UnitResult>> results) {
  std::vector<BlockRow> rows;
  for (auto& [unit, result] : results) {
    if (unit.block >= 0) {
      rows.push_back(std::move(result.row));
    } else {
      add_queries(unit.ceiling, result.ceilings);
    }
  }
  if (rows.empty()) return;
  store_.put(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ++blocks_done_;
    if (run_.progress) run_.progress(blocks_done_, blocks_total_);
  }
}

void ResultRecorder::add_queries(int ceiling,
                                 const std::vector<std::pair<int, QueryCeiling>>& queries) {
  QueryCeilings& of_query = of_query_[ceiling];
  of_query.resize(
      static_cast<std::size_t>(work_.ceilings[static_cast<std::size_t>(ceiling)].queries));
  for (const auto& [query, found] : queries) {
    of_query[static_cast<std::size_t>(query)] = found;
    ++queries_done_;
    if (run_.ceiling_progress) run_.ceiling_progress(queries_done_, queries_total_);
  }
  uncommitted_ += static_cast<int>(queries.size());
  constexpr int at_a_time = 500;
  if (uncommitted_ >= at_a_time) flush();
}

void ResultRecorder::flush() {
  for (const auto& [ceiling, of_query] : of_query_) {
    const auto [part, text] =
        ceiling_part(work_.ceilings[static_cast<std::size_t>(ceiling)].key, of_query);
    if (!text.empty()) store_.set_note(part, text);
  }
  of_query_.clear();
  uncommitted_ = 0;
}

}  // namespace vernier::sim::internal
