// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/interval.h"
#include "calib/rig_estimate.h"
#include "sim/experiment.h"
#include "sim/study/block_outcomes.h"
#include "sim/study/budget.h"
#include "sim/study/cell_summary.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/reliability.h"
#include "sim/study/study_file.h"
#include "sim/told/fresh_calibrations.h"
#include "sim/world.h"

namespace vernier::sim::internal {

class Communicator;
class StoredResults;
struct StudyWork;

/// A world or a rig with the fingerprint of its file's content.
struct StudyWorld {
  World world;
  std::string fingerprint;
};
struct StudyRig {
  RigEstimate estimate;
  std::string fingerprint;
};

/// A study with all files that it refers to loaded.
struct Study {
  StudyFile file;
  World world;                                       ///< of the first cell
  RigEstimate rig;                                   ///< the true one, in all cells
  std::string world_fingerprint, rig_fingerprint;    ///< of the files' content
  std::map<std::string, StudyWorld> other_worlds;    ///< that a sweep names beside, by name
  std::map<std::string, StudyRig> told_rigs;         ///< by name, if there is a rig.truth
  std::shared_ptr<const BoardObservations> corners;  ///< of calibration.observations, or null
  std::string corners_fingerprint;
};

const World& world_of(const Study& study, const StudyCell& cell);
const std::string& world_fingerprint_of(const Study& study, const StudyCell& cell);

/// Which blocks this process runs: block i belongs to shard i mod count.
struct Shard {
  int index = 0, count = 1;
};

struct StudyRun {
  std::filesystem::path folder;  ///< results are stored here, and resumed from here
  int threads = 0;               ///< 0: all cores
  Shard shard;
  std::string command;       ///< command line of this run; stored with its results
  std::string machine = {};  ///< program and machine of this run, in a line; stored as well
  /// Called from any thread, one call at a time.
  std::function<void(int done, int total)> progress;
  /// The same for the queries of the world ceilings, which are computed before the first block.
  std::function<void(int done, int total)> ceiling_progress;
  /// The same for the calibrations that are recorded before (calibration_records.h).
  std::function<void(int done, int total)> calibration_progress = {};
  /// Called when this process has become the writer of its store, before anything is computed; not
  /// if nothing is missing.
  std::function<void()> on_start = {};
  /// Once it asks to stop, no further block or query is begun; those done are stored.
  std::stop_token stop = {};
  /// Whether results of another kind of processor may be in the folder, or come from other ranks.
  OtherInstructionSets other_instruction_sets = OtherInstructionSets::refused;
  /// The other processes that compute for this one, which is their rank 0 (study_ranks.h); null:
  /// none. The caller tells them the end.
  Communicator* ranks = nullptr;
  /// Which blocks are wanted, by what is stored so far: the first so many of each cell, never fewer
  /// than before. Asked again when they are all there, until it wants no more. World ceilings are
  /// then not computed. For one process: not with shards or ranks. Null: as the study says.
  std::function<std::vector<int>(const StudyWork& work, const StoredResults& stored)> first_blocks =
      {};
  /// Called with `ranks`, once it was asked to stop and all results that have come are stored. It
  /// may end the process; if it does not, the units that run here are waited for.
  std::function<void()> on_stop = {};
};

/// Runs the missing blocks of this shard. Writes its own store only, and nothing if no block and no
/// ceiling is missing. Throws Error if another process writes the store. Blocks run in parallel,
/// each on one thread, as do the queries of a ceiling, so results do not depend on the number of
/// threads; an interrupted run can be resumed. Shards share the queries of a ceiling. The caller's
/// own parallel work is not limited: TBB's limit for the process is raised during the run if more
/// threads are asked for, never lowered, and a limit that the caller holds stays.
void run_study(const Study& study, const StudyRun& run);

/// The limit that a world sets for localisers of one look, for the queries of a cell (ceiling.h).
struct WorldCeiling {
  double success = 1;    ///< mean success of the best guess among poses that look the same
  double unaliased = 1;  ///< share of the views that no other pose has at which the protocol asks
  /// For further queries: Wilson's, for which guesses vary no more than trials that fail or do not.
  Interval success_interval_95, unaliased_interval_95;
  int queries = 0;
};

/// Results of a cell.
struct CellResult {
  StudyCell cell;
  CellSummary summary;
  StatedErrors stated;                        ///< how sure the localiser was, and how right
  std::vector<ClusterCount> maps;             ///< one entry per block
  std::vector<BlockOutcomes> outcomes;        ///< the same
  std::vector<TrialResult> trials;            ///< ascending; the first, as many as were asked for
  int trials_per_block = 50;                  ///< trial t belongs to block t / trials_per_block
  std::optional<WorldCeiling> ceiling;        ///< none until all of its queries are stored
  std::optional<double> interval_width = {};  ///< at which the study stops the cell
  BudgetDecision budget = {};
  /// Of a cell with [calibration]: what became of the calibrations of its first trials.
  std::optional<CalibrationRecord> calibrations = {};
};

/// The part of a study that is stored in the folder.
struct StudyResults {
  std::vector<CellResult> cells;
  int blocks_done = 0, blocks_total = 0;
  std::vector<std::string> commands;  ///< that produced them, ascending; none for old results
  std::vector<std::string> machines;  ///< on which, the same
  std::string instruction_sets;       ///< "AVX2", or "AVX2, AVX3" where a mixture was allowed
  std::vector<Shard> missing_shards;  ///< that lack something, if stores of shards are there
  /// Commands of programs whose files were others at the run: edited, or not found from here.
  std::vector<std::string> changed_programs;
};

/// The store that a shard writes.
std::filesystem::path store_file(const std::filesystem::path& folder, const Shard& shard);

/// Key of a command, and of a machine, in a store's notes.
std::string command_key(const std::string& command);
std::string machine_key(const std::string& machine);

/// Reads all stores of the folder. Throws Error if a store is damaged, or two disagree. So many
/// trials of each cell are kept, at most; memory grows with them, and by 24 bytes a trial of the
/// largest cell.
StudyResults study_results(const Study& study,
                           const std::filesystem::path& folder,
                           std::size_t kept_of_a_cell);
/// The same with all trials.
StudyResults study_results(const Study& study, const std::filesystem::path& folder);

/// Called with each block that is done, cell by cell, its trials ascending; `cell` is the place in
/// StudyFile::cells.
using BlockVisitor = std::function<void(std::size_t cell, const std::vector<TrialResult>& trials)>;

/// Counts of the maps only: CellResult has neither trials, which are given to `visit` instead, nor
/// figures.
StudyResults visit_results(const Study& study,
                           const std::filesystem::path& folder,
                           const BlockVisitor& visit);

}  // namespace vernier::sim::internal
