// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/interval.h"
#include "sim/experiment.h"
#include "sim/study/budget.h"
#include "sim/study/cell_tally.h"
#include "sim/study/stored_results.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/study/system_kind.h"

namespace vernier::sim::internal {

namespace {

/// Results without trials: cells, ceilings, commands.
StudyResults without_trials(const Study& study,
                            const StudyWork& work,
                            const StoredResults& stored) {
  StudyResults results;
  const std::vector<BudgetDecision> decisions = budget_decisions(study, work, stored);
  const std::vector<int> wanted = most_wanted(work, blocks_wanted(decisions));
  results.blocks_total = std::accumulate(wanted.begin(), wanted.end(), 0);
  std::set<std::string> commands, machines;
  for (const auto& [key, value] : stored.notes()) {
    if (key == command_key(value)) commands.insert(value);
    if (key == machine_key(value)) machines.insert(value);
  }
  results.commands.assign(commands.begin(), commands.end());
  results.machines.assign(machines.begin(), machines.end());
  results.instruction_sets = stored.instruction_sets();
  results.missing_shards = missing_shards(study, work, stored);
  for (const StudyCell& cell : study.file.cells) {
    CellResult result;
    result.cell = cell;
    result.trials_per_block = study.file.trials_per_block;
    if (cell.system.is_localiser()) {
      result.ceiling = noted_ceiling(study, stored.notes(), ceiling_key(study, cell));
    }
    if (cell.told.calibration) {
      result.calibrations = noted_calibrations(stored.notes(), calibration_key(study, cell));
    }
    result.interval_width = study.file.interval_width;
    result.budget = decisions[results.cells.size()];
    results.cells.push_back(std::move(result));
  }
  return results;
}

/// A stored block as the study wants it: it may have more trials.
std::vector<TrialResult> wanted_trials(StoredBlock block,
                                       const StudyCell& cell,
                                       const BlockJob& job,
                                       const std::filesystem::path& folder) {
  if (block.trials[0].trial != static_cast<std::uint32_t>(job.first)) {
    throw Error(folder.string(), fmt::format("block {} holds other trials", job.block),
                "delete the stores of the folder and run the study again");
  }
  const bool measures = !cell.system.is_localiser();
  const std::size_t measured = cell.system.measured_names.size();
  if (std::any_of(block.trials.begin(), block.trials.end(), [&](const TrialResult& trial) {
        return trial.measured.has_value() != measures ||
               (measures && trial.measured->size() != measured);
      })) {
    throw Error(folder.string(), fmt::format("block {} holds trials of another system", job.block),
                "delete the stores of the folder and run the study again");
  }
  block.trials.resize(static_cast<std::size_t>(job.count));
  return std::move(block.trials);
}

enum class Figures { made, left_out };

/// The keys of stored cells by what is left of them without the files of programs: of several the
/// one that has most blocks.
std::map<std::string, std::string> without_programs(
    const std::map<std::string, std::size_t>& cells) {
  std::map<std::string, std::string> most;
  for (const auto& [cell, blocks] : cells) {
    const auto [found, is_new] = most.emplace(without_program_files(cell), cell);
    if (!is_new && blocks > cells.at(found->second)) found->second = cell;
  }
  return most;
}

/// Where nothing is stored of a cell's program as it is now, takes what is stored of an earlier
/// one, the most if there are several: a folder stays readable where it is moved to, and after the
/// program was edited. Returns the commands.
std::vector<std::string> take_earlier_programs(const Study& study,
                                               const StoredResults& stored,
                                               StudyWork& work) {
  const std::map<std::string, std::size_t> cells = stored.cells();
  std::map<std::string, std::string> earlier;  // made where it is needed
  std::set<std::string> commands;
  for (std::size_t i = 0; i < work.cell_keys.size(); ++i) {
    std::string& key = work.cell_keys[i];
    if (cells.contains(key)) continue;
    const std::string bare = without_program_files(key);
    if (bare == key) continue;
    if (earlier.empty()) earlier = without_programs(cells);
    const auto found = earlier.find(bare);
    if (found == earlier.end()) continue;
    key = found->second;
    const ExperimentSettings& settings = study.file.cells[i].experiment;
    if (!settings.sources.command.empty()) commands.insert(settings.sources.command);
    if (settings.method == "program") commands.insert(settings.localiser.command);
    const std::string command = study.file.cells[i].system.command();
    if (!command.empty()) commands.insert(command);
  }
  return {commands.begin(), commands.end()};
}

StudyResults visit_blocks(const Study& study,
                          const std::filesystem::path& folder,
                          Figures figures,
                          const BlockVisitor& visit) {
  StoredResults stored;
  stored.add_folder(folder);
  stored.require_all_read();
  StudyWork work = study_work(study);
  const std::vector<std::string> changed = take_earlier_programs(study, stored, work);
  StudyResults results = without_trials(study, work, stored);
  results.changed_programs = changed;
  const std::size_t cells = results.cells.size();
  const std::vector<std::vector<BlockJob>> jobs = jobs_by_cell(work);
  std::vector<int> done_of(cells, 0);  // blocks of cells that share them, the most
  constexpr int at_a_time = 200;       // blocks read together
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const auto source = static_cast<std::size_t>(work.same_as[cell]);
    const int wanted = results.cells[cell].budget.wanted;  // fewer: a cell that has stopped
    CellResult& result = results.cells[cell];
    CellTally tally(result);
    int done = 0;
    for (int from = 0; from < wanted; from += at_a_time) {
      const int end = std::min(from + at_a_time, wanted);
      for (StoredBlock& block : blocks_of(result.cell, {work.cell_keys[cell], from, end}, stored)) {
        const BlockJob& job = jobs[source][static_cast<std::size_t>(block.block)];
        if (static_cast<int>(block.trials.size()) < job.count) continue;
        const std::vector<TrialResult> trials =
            wanted_trials(std::move(block), result.cell, job, folder);
        ++done;
        result.maps.push_back(count_of(trials));
        if (figures == Figures::made) tally.add(trials);
        visit(cell, trials);
      }
    }
    if (figures == Figures::made) tally.finish();
    done_of[source] = std::max(done_of[source], done);
  }
  results.blocks_done = std::accumulate(done_of.begin(), done_of.end(), 0);
  return results;
}

}  // namespace

StudyResults visit_results(const Study& study,
                           const std::filesystem::path& folder,
                           const BlockVisitor& visit) {
  return visit_blocks(study, folder, Figures::left_out, visit);
}

StudyResults study_results(const Study& study,
                           const std::filesystem::path& folder,
                           std::size_t kept_of_a_cell) {
  std::vector<std::vector<TrialResult>> kept(study.file.cells.size());
  StudyResults results = visit_blocks(
      study, folder, Figures::made, [&](std::size_t cell, const std::vector<TrialResult>& trials) {
        const std::size_t room = kept_of_a_cell - kept[cell].size();
        kept[cell].insert(
            kept[cell].end(), trials.begin(),
            trials.begin() + static_cast<std::ptrdiff_t>(std::min(room, trials.size())));
      });
  for (std::size_t i = 0; i < kept.size(); ++i) results.cells[i].trials = std::move(kept[i]);
  return results;
}

StudyResults study_results(const Study& study, const std::filesystem::path& folder) {
  return study_results(study, folder, std::numeric_limits<std::size_t>::max());
}

}  // namespace vernier::sim::internal
