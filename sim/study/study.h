// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
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
  int threads = 0;               ///< 0: as many as there are
  Shard shard;
  std::string command;                                ///< that this run is; kept beside its results
  std::function<void(int done, int total)> progress;  ///< called from any thread, one at a time
  /// The same of the queries whose world ceiling is worked out before the first block.
  std::function<void(int done, int total)> ceiling_progress;
};

/// Runs what is missing of this shard. Blocks run in parallel, each on one thread, and so do the
/// queries of a ceiling, so results do not depend on the number of threads; a killed run goes on
/// where it was. The caller's own parallel work is not limited.
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

}  // namespace vernier::sim::internal
