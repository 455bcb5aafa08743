// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_merge.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/error.h"
#include "cli/program/session.h"
#include "cli/simulation/folder_claim.h"
#include "cli/simulation/study_doubts.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/study_inputs.h"
#include "cli/simulation/study_table.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/store_rows.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_difference.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"

namespace vernier::cli {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t rows_at_a_time = 200;  // committed together

/// Throws Error unless all parts belong to the same study.
StoredResults read_parts(const std::vector<fs::path>& parts,
                         const fs::path& target,
                         const Study& first,
                         OtherInstructionSets others,
                         Session& session) {
  StoredResults all(others);
  for (const fs::path& part : parts) {
    if (fs::exists(target) && fs::equivalent(part, target)) {
      throw Error(part.string(), "is also the output folder", "give another -o DIR");
    }
    const Study study = open_folder(part, session);
    std::string why = study_difference(study, first);
    if (why.empty()) why = study_difference(first, study);
    const bool is_limit = why.empty();
    if (why.empty()) why = limit_difference(study, first);
    if (why.empty()) why = limit_difference(first, study);
    if (!why.empty()) {
      throw Error(part.string(),
                  "is not part of the same study as " + parts[0].string() + ": " + why,
                  is_limit ? "run one again with the other's limit, which takes no trials"
                           : "merge only parts of one study");
    }
    all.add_folder(part);
    all.require_all_read();
  }
  return all;
}

/// Copies the blocks of one store that are the best of all.
void copy_blocks(const fs::path& file, const StoredResults& all, StudyStore& merged) {
  std::vector<BlockRow> rows;
  const auto put = [&] {
    merged.put(rows);
    rows.clear();
  };
  visit_store(file, [&](const BlockRow& row) {
    if (!all.is_best(file, row.cell, row.block)) return;
    rows.push_back(row);
    if (rows.size() == rows_at_a_time) put();
  });
  put();
}

/// A merge that was killed may leave in its target what only the next writer can mend.
void mend_store(const fs::path& file) {
  if (!fs::is_regular_file(file) || !read_index(file).interrupted) return;
  const StudyStore writer(file, OtherInstructionSets::allowed);
}

}  // namespace

void merge_studies(const std::vector<fs::path>& parts,
                   const fs::path& target,
                   OtherInstructionSets others,
                   Session& session) {
  const Study study = open_folder(parts[0], session);
  StoredResults all = read_parts(parts, target, study, others, session);
  mend_store(store_file(target, {}));
  all.add_folder(target);
  all.require_all_read();
  all.check_agreement();
  const std::vector<Shard> missing = missing_shards(study, study_work(study), all);
  for (const StudyCell& cell : study.file.cells) {  // throws if parts disagree on a ceiling
    noted_queries(study, all.notes(), ceiling_key(study, cell));
  }
  const FolderClaim claim(study, inputs_of_folder(parts[0]), target);
  try {
    const fs::path file = store_file(target, {});
    // what this processor is does not matter: nothing is computed here
    StudyStore merged(file, OtherInstructionSets::allowed);
    claim.extend();
    for (const auto& [key, value] : all.notes()) merged.set_note(key, value);
    for (const fs::path& from : all.files()) {
      if (from != file) copy_blocks(from, all, merged);
    }
    merged.set_note(command_key(session.command), session.command);
  } catch (...) {
    claim.withdraw({});
    throw;
  }
  const StudyResults results = study_results(study, target, 0);
  if (results.blocks_done < results.blocks_total) {
    session.add_trust_warning(
        fmt::format("{} of {} blocks are missing from the merged study{}",
                    results.blocks_total - results.blocks_done, results.blocks_total,
                    missing.empty() ? "" : "; run " + shard_options(missing) + " and merge again"));
  }
  if (results.blocks_done == results.blocks_total && !missing.empty()) {
    session.add_trust_warning(
        "queries of the world ceiling are missing from the merged study; run " +
        shard_options(missing) + " and merge again");
  }
  tell(doubts_of(study, results), session);
  session.result(study_json(study, results), study_table(study, results));
}

}  // namespace vernier::cli
