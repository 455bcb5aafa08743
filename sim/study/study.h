// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/interval.h"
#include "calib/rig_estimate.h"
#include "sim/experiment.h"
#include "sim/study/study_file.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// A study with everything it names loaded.
struct Study {
  StudyFile file;
  World world;
  RigEstimate rig;
  std::string world_fingerprint, rig_fingerprint;  ///< of the files' content
};

/// Which part of the blocks this process does: block i belongs to shard i mod count.
struct Shard {
  int index = 0, count = 1;
};

struct StudyRun {
  std::filesystem::path folder;  ///< results are kept, and resumed from, here
  int threads = 0;               ///< 0: as many as there are cores
  Shard shard;
  std::string command;                                ///< that this run is; kept beside its results
  std::function<void(int done, int total)> progress;  ///< called from any thread, one at a time
  /// The same of the queries whose world ceiling is worked out before the first block.
  std::function<void(int done, int total)> ceiling_progress;
};

/// Runs what is missing of this shard. Blocks run in parallel, each on one thread, and so do the
/// queries of a ceiling, so results do not depend on the number of threads; a killed run goes on
/// where it was. The queries of a ceiling are shared among shards. The caller's own parallel work
/// is not limited: TBB's limit for the process is raised during the run where more threads are
/// asked for, never lowered, and one that the caller holds stays.
void run_study(const Study& study, const StudyRun& run);

/// A cell's results.
struct CellResult {
  StudyCell cell;
  std::vector<TrialResult> trials;  ///< ascending
  std::vector<ClusterCount> maps;   ///< by block
  int trials_per_block = 50;        ///< trial t is of block t / trials_per_block
  double ceiling = 1;               ///< the world's, for this cell's protocol and mount
};

/// How much of the study the folder holds.
struct StudyResults {
  std::vector<CellResult> cells;
  int blocks_done = 0, blocks_total = 0;
  std::vector<std::string> commands;  ///< that made them; ascending, none of old results
};

/// The key under which a store's notes hold a command.
std::string command_key(const std::string& command);

/// Reads all stores of the folder. Throws Error where two shards disagree on a block.
StudyResults study_results(const Study& study, const std::filesystem::path& folder);

/// Figures of a cell.
struct CellSummary {
  int trials = 0;
  int maps = 0;  ///< recorded for them
  double success = 0;
  std::optional<Interval> success_interval_95;  ///< clustered by map (success_interval.h)
  std::string why_no_interval;                  ///< "needs 6 maps, has 1"; empty where there is one
  Interval success_interval_binomial_95;        ///< Wilson as if trials were independent
  double coverage = 0;                          ///< share answered
  double success_when_answered = 0;
  double node_success = 0;               ///< of the map's node instead of the refined pose
  double recall_05 = 0, recall_025 = 0;  ///< 0.5 m and 5°, 0.25 m and 2°
  double median_error_m = 0;             ///< over answered trials
  double median_heading_error_rad = 0;
  double cpu_ms_mean = 0, cpu_ms_median = 0, cpu_ms_p95 = 0, wall_ms_mean = 0;
};
CellSummary summarise(const CellResult& cell);

/// Whether two cells asked in the same places: every trial that both have begins at the same pose,
/// and there is one. Not so where the seed or the protocol of the queries is swept.
bool share_queries(const CellResult& a, const CellResult& b);

/// Two cells on the same trials: in how many both succeeded, one alone, neither. The p-values are
/// those of "neither is better", not a number for fewer than six maps.
struct PairedComparison {
  int both = 0, only_a = 0, only_b = 0, neither = 0;
  int maps = 0;
  double p_value = std::numeric_limits<double>::quiet_NaN();    ///< paired t over maps
  double mcnemar_p = std::numeric_limits<double>::quiet_NaN();  ///< exact, as if independent
};

/// Throws Error where the cells do not share their queries.
PairedComparison compare(const CellResult& a, const CellResult& b);

/// Pairs of cells worth a comparison: each with the nearest one before it that shares its queries.
std::vector<std::pair<std::size_t, std::size_t>> comparable_pairs(
    const std::vector<CellResult>& cells);

}  // namespace vernier::sim::internal
