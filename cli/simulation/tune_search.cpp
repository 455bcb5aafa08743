// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/tune_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "cli/program/machine.h"
#include "cli/program/session.h"
#include "cli/simulation/folder_claim.h"
#include "cli/simulation/study_doubts.h"
#include "cli/simulation/study_inputs.h"
#include "cli/simulation/study_run.h"
#include "cli/simulation/tune_result.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_work.h"
#include "sim/tuning/confirmation.h"
#include "sim/tuning/objective.h"
#include "sim/tuning/race.h"
#include "sim/tuning/race_search.h"
#include "sim/tuning/tune_settings.h"

namespace vernier::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* search_folder = "search";

/// The study of a file with its [tune].
struct Tuning {
  std::string text;
  fs::path file;
  Study study;
  TuneSettings settings;
  std::vector<Candidate> candidates;
};

Tuning load_tuning(const fs::path& file, Session& session) {
  Tuning tuning{read_whole(file), file, {}, {}, {}};
  tuning.study = load_study(tuning.text, file, session);
  tuning.settings = parse_tune(tuning.text, file.string(), tuning.study.file);
  tuning.candidates = candidates_of(tuning.study.file, tuning.settings, file.string());
  return tuning;
}

std::string confirming_text(const Tuning& tuning, int candidate) {
  return confirmation_text(tuning.text, tuning.file.string(),
                           tuning.candidates[static_cast<std::size_t>(candidate)], tuning.settings);
}

/// Before anything is computed: that the worlds to confirm on are there, and none is one that is
/// searched, by whatever name.
void check_confirmation(const Tuning& tuning) {
  Session silent;
  silent.quiet = true;
  const Study confirming = load_study(confirming_text(tuning, 0), tuning.file, silent);
  for (const StudyCell& cell : confirming.file.cells) {
    for (const StudyCell& searched : tuning.study.file.cells) {
      if (world_fingerprint_of(confirming, cell) != world_fingerprint_of(tuning.study, searched)) {
        continue;
      }
      throw Error(tuning.file.string(),
                  fmt::format("tune.confirm_worlds: {} is the searched world {}",
                              in_quotes(cell.world), in_quotes(searched.world)),
                  "name worlds that the study does not use");
    }
  }
}

/// Throws Error if the folder holds what `tune` does not write.
void check_folder(const fs::path& folder) {
  std::error_code unknown;
  if (!fs::exists(folder, unknown)) return;
  if (!fs::is_directory(folder, unknown)) {
    throw Error(folder.string(), "exists and is not a folder", "give another -o DIR");
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name[0] == '.' || name == search_folder || name == tune_result_file ||
        name.rfind("confirm-", 0) == 0) {
      continue;
    }
    throw Error(folder.string(),
                fmt::format("holds other files ({}) and no search of tune", in_quotes(name)),
                "give a new or an empty folder as -o DIR");
  }
}

StudyRun job_in(const fs::path& folder, const TuneOptions& options, const Session& session) {
  StudyRun job;
  job.folder = folder;
  job.threads = options.threads;
  job.command = session.command;
  job.machine = program_and_machine();
  job.other_instruction_sets = options.allow_other_instruction_set ? OtherInstructionSets::allowed
                                                                   : OtherInstructionSets::refused;
  return job;
}

StudyResults race(const Tuning& tuning,
                  RaceSearch& search,
                  const TuneOptions& options,
                  Session& session) {
  const fs::path folder = fs::path(options.folder) / search_folder;
  const FolderClaim claim(tuning.study, inputs_of_study(tuning.text, tuning.file), folder);
  StudyRun job = job_in(folder, options, session);
  job.first_blocks = [&](const StudyWork& work, const StoredResults& stored) {
    return search.first_blocks(work, stored);
  };
  run_in_folder(claim, tuning.study, std::move(job), "tune: race", session);
  StudyResults results = study_results(tuning.study, folder);
  for (const CellResult& cell : results.cells) {
    if (const int failed = cell.summary.failed; failed > 0) {
      session.warn(fmt::format("{} of {} trials of cell \"{}\" have failed", failed,
                               cell.summary.trials, cell.cell.label));
    }
  }
  return results;
}

/// Runs a candidate on what was not searched.
StudyResults confirm(const Tuning& tuning,
                     int candidate,
                     const TuneOptions& options,
                     Session& session) {
  const std::string text = confirming_text(tuning, candidate);
  const fs::path folder = fs::path(options.folder) / confirmation_folder(candidate);
  Session silent;
  silent.quiet = true;
  const Study study = load_study(text, tuning.file, silent);
  const FolderClaim claim(study, inputs_of_study(text, tuning.file), folder);
  StudyRun job = job_in(folder, options, session);
  job.first_blocks = [](const StudyWork& work, const StoredResults&) {  // all, without ceilings
    return std::vector<int>(work.cell_keys.size(), static_cast<int>(work.blocks.size()));
  };
  run_in_folder(claim, study, std::move(job),
                fmt::format("tune: confirmation of candidate {}", candidate + 1), session);
  StudyResults results = study_results(study, folder);
  tell(doubts_of(study, results), session);
  return results;
}

CandidateFigures all_figures(const StudyResults& results, Objective objective) {
  std::vector<int> cells(results.cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = static_cast<int>(i);
  return figures_of(results, cells, objective);
}

void add_search(const Tuning& tuning,
                const RaceSearch& search,
                const StudyResults& results,
                TuneResult& result) {
  result.settings = tuning.settings;
  result.candidates = tuning.candidates;
  result.race = search.state();
  result.order = ranking(search.state(), search.scores());
  result.rounds = search.rounds();
  for (std::size_t i = 0; i < tuning.candidates.size(); ++i) {
    result.searched.push_back(figures_of(results, tuning.candidates[i].cells,
                                         tuning.settings.objective,
                                         search.state().racers[i].rounds));
  }
  result.worlds = worlds_of(tuning.study.file);
  std::set<std::uint64_t> seeds;
  for (const StudyCell& cell : tuning.study.file.cells) seeds.insert(cell.experiment.seed);
  result.seeds.assign(seeds.begin(), seeds.end());
  result.shortfall_limit =
      shortfall_limit(search.scores(), search.state().leader, tuning.settings.race.error_rate);
  result.cost = cost_of(tuning.study, tuning.candidates, search.state(), results);
}

}  // namespace

TuneResult tune_study(const TuneOptions& options, Session& session) {
  const Tuning tuning = load_tuning(options.file, session);
  check_new_study(tuning.study, fs::path(options.folder) / search_folder, session);
  check_confirmation(tuning);
  check_folder(options.folder);
  RaceSearch search(tuning.study, tuning.candidates, tuning.settings);
  const StudyResults searched = race(tuning, search, options, session);
  TuneResult result;
  add_search(tuning, search, searched, result);
  result.winner.candidate = search.state().leader;
  result.reference.candidate = result.winner.candidate == 0 ? result.order[1] : 0;
  const StudyResults of_winner = confirm(tuning, result.winner.candidate, options, session);
  const StudyResults of_reference = confirm(tuning, result.reference.candidate, options, session);
  result.winner.figures = all_figures(of_winner, tuning.settings.objective);
  result.reference.figures = all_figures(of_reference, tuning.settings.objective);
  result.difference = confirmed_difference(of_winner, of_reference, tuning.settings.objective);
  return result;
}

}  // namespace vernier::cli
