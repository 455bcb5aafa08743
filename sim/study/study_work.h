// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calib/interval.h"
#include "sim/experiment.h"
#include "sim/study/budget.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"

namespace vernier::sim::internal {

/// A block of trials of a cell.
struct BlockJob {
  int cell = 0;  ///< place in StudyFile::cells
  int block = 0;
  int first = 0, count = 0;  ///< its trials
};

/// The queries of a world ceiling, which several cells may share.
struct CeilingJob {
  std::string key;                  ///< ceiling_key()
  const StudyCell* cell = nullptr;  ///< one of them
  int queries = 0;
};

/// All that a study computes, in a fixed order. Of n shards, shard s has the blocks and, of each
/// ceiling, the queries whose place is s modulo n.
struct StudyWork {
  std::vector<std::string> cell_keys;
  /// The first cell with the same key, often itself: cells that do not differ share its blocks.
  std::vector<int> same_as;
  std::vector<BlockJob> blocks;
  std::vector<CeilingJob> ceilings;  ///< ascending by key
};

/// Points into the study, which must outlive it.
StudyWork study_work(const Study& study);

/// A digest of everything that a study's results depend on: processes that work on it together must
/// agree on it.
std::string work_fingerprint(const StudyWork& work);

/// Makes trials succeed by the limit of their cell.
void apply_limit(const StudyCell& cell, std::vector<TrialResult>& trials);

/// How many of some trials succeed.
ClusterCount count_of(const std::vector<TrialResult>& trials);

/// The stored blocks of a range of a cell, their successes by the cell's limit: a row counts by
/// that of the study that made it.
std::vector<StoredBlock> blocks_of(const StudyCell& cell,
                                   const BlockRange& range,
                                   const StoredResults& stored);

/// Of what each cell wants, the most of those that share its blocks, for the first of them; 0 for
/// the others.
std::vector<int> most_wanted(const StudyWork& work, const std::vector<int>& of_cells);

/// How far each cell has to go, by what is stored (budget.h).
std::vector<BudgetDecision> budget_decisions(const Study& study,
                                             const StudyWork& work,
                                             const StoredResults& stored);

/// The blocks of each cell, ascending; none of one that shares another's.
std::vector<std::vector<BlockJob>> jobs_by_cell(const StudyWork& work);

/// How many blocks each cell wants.
std::vector<int> blocks_wanted(const std::vector<BudgetDecision>& decisions);

/// What of it is not stored, of the blocks that are wanted so far.
struct MissingWork {
  std::vector<int> blocks;                ///< places in StudyWork::blocks
  std::vector<std::vector<int>> queries;  ///< of each ceiling
  bool empty() const;
};

/// Of a shard. Throws Error if stores disagree on a ceiling.
MissingWork missing_work(const Study& study,
                         const StudyWork& work,
                         const Shard& shard,
                         const StoredResults& stored);

/// Of a process that runs alone: of the first so many blocks of each cell, and no queries.
MissingWork missing_blocks(const StudyWork& work,
                           const std::vector<int>& first_blocks,
                           const StoredResults& stored);

/// Shards that lack a block or a query, of every number of shards that a store is named after
/// ("results-1-of-4.sqlite"); ascending. Empty if nothing is missing or no store is a shard's.
std::vector<Shard> missing_shards(const Study& study,
                                  const StudyWork& work,
                                  const StoredResults& stored);

/// The shard that a store's name says; {0, 1} for the store of a whole study.
Shard shard_of_store(const std::filesystem::path& file);

}  // namespace vernier::sim::internal
