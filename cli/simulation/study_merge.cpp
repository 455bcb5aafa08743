// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/study_merge.h"

#include <string>
#include <utility>

#include "calib/error.h"
#include "cli/program/session.h"
#include "cli/simulation/folder_claim.h"
#include "cli/simulation/study_folder.h"
#include "cli/simulation/study_table.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_difference.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"

namespace vernier::cli {

namespace {

namespace fs = std::filesystem;

void add_folder(const fs::path& folder, StoredResults& all) {
  for (const auto& file : store_files(folder)) all.add(read_store(file), file);
  all.require_all_read();
}

/// Throws Error unless all parts belong to the same study.
StoredResults read_parts(const std::vector<fs::path>& parts,
                         const fs::path& target,
                         const Study& first,
                         Session& session) {
  StoredResults all;
  for (const fs::path& part : parts) {
    if (fs::exists(target) && fs::equivalent(part, target)) {
      throw Error(part.string(), "is also the output folder", "give another -o DIR");
    }
    const Study study = open_folder(part, session);
    std::string why = study_difference(study, first);
    if (why.empty()) why = study_difference(first, study);
    if (!why.empty()) {
      throw Error(part.string(),
                  "is not part of the same study as " + parts[0].string() + ": " + why,
                  "merge only parts of one study");
    }
    add_folder(part, all);
  }
  return all;
}

}  // namespace

void merge_studies(const std::vector<fs::path>& parts, const fs::path& target, Session& session) {
  const Study study = open_folder(parts[0], session);
  StoredResults all = read_parts(parts, target, study, session);
  add_folder(target, all);
  for (const StudyCell& cell : study.file.cells) {  // throws if parts disagree on a ceiling
    noted_queries(study, all.notes, ceiling_key(study, cell.experiment));
  }
  const FolderClaim claim(study, inputs_of_folder(parts[0]), target);
  try {
    StudyStore merged(store_file(target, {}));
    claim.extend();
    for (const auto& [key, block] : all.blocks) merged.put(block);
    for (const auto& [key, value] : all.notes) merged.set_note(key, value);
    merged.set_note(command_key(session.command), session.command);
  } catch (...) {
    claim.withdraw({});
    throw;
  }
  const StudyResults results = study_results(study, target);
  if (results.blocks_done < results.blocks_total) {
    session.add_trust_warning(fmt::format("{} of {} blocks are missing from the merged study",
                                          results.blocks_total - results.blocks_done,
                                          results.blocks_total));
  }
  session.result(study_json(study, results), study_table(study, results));
}

}  // namespace vernier::cli
