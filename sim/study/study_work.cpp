// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "calib/base/fingerprint.h"
#include "calib/interval.h"
#include "sim/experiment.h"
#include "sim/study/budget.h"
#include "sim/study/ceiling.h"
#include "sim/study/store_rows.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"
#include "sim/study/system_kind.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

StudyWork study_work(const Study& study) {
  StudyWork work;
  std::map<std::string, const StudyCell*> ceilings;
  const int trials = study.file.trials, size = study.file.trials_per_block;
  std::map<std::string, int> first_with;
  for (const StudyCell& cell : study.file.cells) {
    const int number = static_cast<int>(work.cell_keys.size());
    work.cell_keys.push_back(cell_key(study, cell));
    work.same_as.push_back(first_with.emplace(work.cell_keys.back(), number).first->second);
    if (cell.system.is_localiser()) ceilings.emplace(ceiling_key(study, cell), &cell);
    if (work.same_as.back() != number) continue;
    for (int first = 0, block = 0; first < trials; first += size, ++block) {
      work.blocks.push_back({number, block, first, std::min(size, trials - first)});
    }
  }
  for (const auto& [key, cell] : ceilings) {
    work.ceilings.push_back({key, cell, ceiling_queries(study, key)});
  }
  return work;
}

std::string work_fingerprint(const StudyWork& work) {
  std::string all;
  for (const std::string& key : work.cell_keys) all += key + "\n";
  for (const CeilingJob& ceiling : work.ceilings) {
    all += fmt::format("{} {}\n", ceiling.key, ceiling.queries);
  }
  for (const BlockJob& job : work.blocks) {
    all += fmt::format("{} {} {} {}\n", job.cell, job.block, job.first, job.count);
  }
  return fingerprint(all);
}

bool MissingWork::empty() const {
  return blocks.empty() && std::all_of(queries.begin(), queries.end(),
                                       [](const std::vector<int>& of) { return of.empty(); });
}

namespace {

/// Of the first blocks of a cell, without a gap.
std::vector<ClusterCount> first_counts(const StudyCell& cell,
                                       const std::string& key,
                                       const std::vector<BlockJob>& jobs,
                                       const StoredResults& stored) {
  constexpr int at_a_time = 200;
  std::vector<ClusterCount> first;
  const int all = static_cast<int>(jobs.size());
  for (int from = 0; from < all; from += at_a_time) {
    const int end = std::min(from + at_a_time, all);
    for (const StoredBlock& block : blocks_of(cell, {key, from, end}, stored)) {
      const ClusterCount count = count_of(block.trials);
      const auto place = static_cast<std::size_t>(block.block);
      if (place != first.size() || count.trials < jobs[place].count) return first;
      first.push_back(count);
    }
    if (static_cast<int>(first.size()) < end) return first;
  }
  return first;
}

/// The same by the counts of rows, whose successes may be by another limit.
std::vector<ClusterCount> first_row_counts(const std::string& key,
                                           const std::vector<BlockJob>& jobs,
                                           const StoredResults& stored) {
  std::vector<ClusterCount> first;
  for (const BlockJob& job : jobs) {
    const ClusterCount count = stored.count(key, job.block);
    if (count.trials < job.count) break;
    first.push_back(count);
  }
  return first;
}

/// Rows of localisers count what is within success_radius_m, those of other systems by the limit of
/// the study that made them.
bool has_limit_of_rows(const SystemSettings& system) {
  return system.is_localiser() && system.success_error == success_radius_m;
}

}  // namespace

void apply_limit(const StudyCell& cell, std::vector<TrialResult>& trials) {
  for (TrialResult& trial : trials) trial.limit = cell.system.success_error;
}

ClusterCount count_of(const std::vector<TrialResult>& trials) {
  const std::array<int, 3> counted = row_counts(trials);
  return {.successes = counted[2], .trials = counted[0]};
}

std::vector<StoredBlock> blocks_of(const StudyCell& cell,
                                   const BlockRange& range,
                                   const StoredResults& stored) {
  std::vector<StoredBlock> blocks = stored.read(range);
  for (StoredBlock& block : blocks) apply_limit(cell, block.trials);
  return blocks;
}

std::vector<std::vector<BlockJob>> jobs_by_cell(const StudyWork& work) {
  std::vector<std::vector<BlockJob>> jobs(work.cell_keys.size());
  for (const BlockJob& job : work.blocks) jobs[static_cast<std::size_t>(job.cell)].push_back(job);
  return jobs;
}

std::vector<int> most_wanted(const StudyWork& work, const std::vector<int>& of_cells) {
  std::vector<int> wanted(of_cells.size(), 0);
  for (std::size_t i = 0; i < of_cells.size(); ++i) {
    int& most = wanted[static_cast<std::size_t>(work.same_as[i])];
    most = std::max(most, of_cells[i]);
  }
  return wanted;
}

std::vector<BudgetDecision> budget_decisions(const Study& study,
                                             const StudyWork& work,
                                             const StoredResults& stored) {
  const std::vector<std::vector<BlockJob>> jobs = jobs_by_cell(work);
  std::vector<BudgetDecision> decisions;
  for (std::size_t i = 0; i < work.cell_keys.size(); ++i) {
    const StudyCell& cell = study.file.cells[i];
    const std::string& key = work.cell_keys[i];
    const std::vector<BlockJob>& all = jobs[static_cast<std::size_t>(work.same_as[i])];
    const bool by_limit = study.file.interval_width && !has_limit_of_rows(cell.system);
    const std::vector<ClusterCount> first =
        by_limit ? first_counts(cell, key, all, stored) : first_row_counts(key, all, stored);
    decisions.push_back(
        budget_decision(first, static_cast<int>(all.size()), study.file.interval_width));
  }
  return decisions;
}

std::vector<int> blocks_wanted(const std::vector<BudgetDecision>& decisions) {
  std::vector<int> wanted;
  for (const BudgetDecision& decision : decisions) wanted.push_back(decision.wanted);
  return wanted;
}

MissingWork missing_work(const Study& study,
                         const StudyWork& work,
                         const Shard& shard,
                         const StoredResults& stored) {
  MissingWork missing;
  const std::vector<int> wanted =
      most_wanted(work, blocks_wanted(budget_decisions(study, work, stored)));
  const int count = static_cast<int>(work.blocks.size());
  for (int i = shard.index; i < count; i += shard.count) {
    const BlockJob& job = work.blocks[static_cast<std::size_t>(i)];
    if (job.block >= wanted[static_cast<std::size_t>(job.cell)]) continue;
    if (stored.trials(work.cell_keys[job.cell], job.block) < job.count) missing.blocks.push_back(i);
  }
  for (const CeilingJob& ceiling : work.ceilings) {
    const QueryCeilings known = noted_queries(study, stored.notes(), ceiling.key);
    std::vector<int>& queries = missing.queries.emplace_back();
    for (int i = shard.index; i < ceiling.queries; i += shard.count) {
      if (!known[static_cast<std::size_t>(i)]) queries.push_back(i);
    }
  }
  return missing;
}

MissingWork missing_blocks(const StudyWork& work,
                           const std::vector<int>& first_blocks,
                           const StoredResults& stored) {
  MissingWork missing;
  missing.queries.resize(work.ceilings.size());
  const std::vector<int> wanted = most_wanted(work, first_blocks);
  for (std::size_t i = 0; i < work.blocks.size(); ++i) {
    const BlockJob& job = work.blocks[i];
    if (job.block >= wanted[static_cast<std::size_t>(job.cell)]) continue;
    if (stored.trials(work.cell_keys[static_cast<std::size_t>(job.cell)], job.block) < job.count) {
      missing.blocks.push_back(static_cast<int>(i));
    }
  }
  return missing;
}

Shard shard_of_store(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  Shard shard;
  if (std::sscanf(name.c_str(), "results-%9d-of-%9d.sqlite", &shard.index, &shard.count) != 2 ||
      shard.index < 0 || shard.index >= shard.count || store_file("", shard) != name) {
    return {};
  }
  return shard;
}

std::vector<Shard> missing_shards(const Study& study,
                                  const StudyWork& work,
                                  const StoredResults& stored) {
  std::set<int> counts;
  for (const auto& file : stored.files()) {
    if (const Shard shard = shard_of_store(file); shard.count > 1) counts.insert(shard.count);
  }
  if (counts.empty()) return {};
  const MissingWork missing = missing_work(study, work, {}, stored);
  std::vector<Shard> shards;
  for (const int count : counts) {
    std::set<int> lacking;
    for (const int block : missing.blocks) lacking.insert(block % count);
    for (const std::vector<int>& queries : missing.queries) {
      for (const int query : queries) lacking.insert(query % count);
    }
    for (const int index : lacking) shards.push_back({index, count});
  }
  return shards;
}

}  // namespace vernier::sim::internal
