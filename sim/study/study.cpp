// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/instruction_set.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/study/calibration_records.h"
#include "sim/study/instruction_sets.h"
#include "sim/study/result_recorder.h"
#include "sim/study/stored_results.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_ranks.h"
#include "sim/study/study_store.h"
#include "sim/study/study_work.h"
#include "sim/study/work_units.h"
#include "sim/study/worker_threads.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Lets the process use more threads than it has cores where a run asks for more, as long as this
/// exists; never fewer than without.
class RaisedThreadLimit {
 public:
  explicit RaisedThreadLimit(int threads) {
    if (allowed(threads) < threads) control_.emplace(limit, static_cast<std::size_t>(threads));
  }

  /// So many of the threads as the process may use: a limit of the caller's own stays.
  int allowed(int threads) const {
    const std::size_t active = tbb::global_control::active_value(limit);
    return static_cast<int>(std::min(static_cast<std::size_t>(threads), active));
  }

 private:
  static constexpr auto limit = tbb::global_control::max_allowed_parallelism;
  std::optional<tbb::global_control> control_;
};

/// Calls work(0) … work(count - 1) on the threads of an arena. `begun` orders what was done before
/// the loop before what its threads do, and `finished` that before what follows, as the loop itself
/// does: the thread sanitizer does not see into TBB.
template <class Work>
void in_parallel(tbb::task_arena& arena, int count, Work work) {
  std::atomic<int> begun = 0, finished = 0;
  begun.store(1, std::memory_order_release);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, count, 1),
        [&](const tbb::blocked_range<int>& range) {
          [[maybe_unused]] const int seen = begun.load(std::memory_order_acquire);
          for (int i = range.begin(); i < range.end(); ++i) {
            work(i);
            finished.fetch_add(1, std::memory_order_release);
          }
        },
        tbb::simple_partitioner());
  });
  [[maybe_unused]] const int ended = finished.load(std::memory_order_acquire);
}

/// Throws Error if the folder's results are of another kind of processor than this one.
void check_processor(const StoredResults& stored, const StudyRun& run) {
  const std::string there = stored.instruction_sets(), here(instruction_set());
  if (there.empty() || has_instruction_sets(there, here)) return;
  if (run.other_instruction_sets == OtherInstructionSets::allowed) return;
  throw Error(run.folder.string(),
              fmt::format("written with instruction set {}, this processor has {}: results would "
                          "not be identical",
                          shortened(there), here),
              "continue in another folder, or give --allow-other-instruction-set");
}

/// Computes units on the threads of an arena, each of which takes the next one when it is free.
void compute_here(const std::vector<WorkUnit>& units,
                  const UnitComputer& computer,
                  const StudyRun& run,
                  tbb::task_arena& arena,
                  ResultRecorder& recorder) {
  std::mutex mutex;
  in_parallel(arena, static_cast<int>(units.size()), [&](int i) {
    if (run.stop.stop_requested()) return;
    const WorkUnit& unit = units[static_cast<std::size_t>(i)];
    std::vector<std::pair<WorkUnit, UnitResult>> done;
    done.emplace_back(unit, computer.compute(unit, run.stop));
    const std::lock_guard lock(mutex);
    recorder.add(std::move(done));
  });
  recorder.flush();
}

/// The same on all ranks. Closes the store if it is asked to stop.
void compute_on_ranks(const std::vector<WorkUnit>& queries,
                      const std::vector<WorkUnit>& blocks,
                      const UnitComputer& computer,
                      const StudyRun& run,
                      RankZero& ranks,
                      ResultRecorder& recorder,
                      std::optional<StudyStore>& store) {
  const tbb::task_arena usual(tbb::task_arena::automatic);
  WorkerThreads own(computer, run.threads > 0 ? run.threads : usual.max_concurrency(), run.stop);
  if (!queries.empty()) {
    recorder.begin_queries();
    ranks.compute(queries, own, recorder);
  }
  recorder.begin_blocks();
  ranks.compute(blocks, own, recorder);
  if (run.stop.stop_requested()) {
    store.reset();
    if (run.on_stop) run.on_stop();
  }
}

}  // namespace

const World& world_of(const Study& study, const StudyCell& cell) {
  return cell.world == study.file.world ? study.world : study.other_worlds.at(cell.world).world;
}

const std::string& world_fingerprint_of(const Study& study, const StudyCell& cell) {
  return cell.world == study.file.world ? study.world_fingerprint
                                        : study.other_worlds.at(cell.world).fingerprint;
}

std::filesystem::path store_file(const std::filesystem::path& folder, const Shard& shard) {
  return folder / (shard.count == 1
                       ? "results.sqlite"
                       : fmt::format("results-{}-of-{}.sqlite", shard.index, shard.count));
}

void run_study(const Study& study, const StudyRun& run) {
  if (run.shard.count < 1 || run.shard.index < 0 || run.shard.index >= run.shard.count) {
    throw Error(fmt::format("shard {}/{}", run.shard.index, run.shard.count),
                "not a valid index/count", "use 0 <= index < count");
  }
  const StudyWork work = study_work(study);
  const auto missing_of = [&](const StoredResults& stored) {
    return run.first_blocks ? missing_blocks(work, run.first_blocks(work, stored), stored)
                            : missing_work(study, work, run.shard, stored);
  };
  std::optional<RankZero> ranks;
  std::string sets(instruction_set());
  if (run.ranks) {
    ranks.emplace(*run.ranks, work, run.stop);
    sets = ranks->meet(run.other_instruction_sets);
  }
  StoredResults stored(run.other_instruction_sets);
  stored.add_folder(run.folder);
  if (missing_of(stored).empty()) {
    if (run.progress) run.progress(0, 0);
    return;
  }
  check_processor(stored, run);
  UnitComputer computer(study, work, run.stop);

  std::filesystem::create_directories(run.folder);
  const std::filesystem::path file = store_file(run.folder, run.shard);
  std::optional<StudyStore> store(std::in_place, file, run.other_instruction_sets);
  if (run.on_start) run.on_start();
  stored.add(store->index(), file);  // it may have been written meanwhile
  stored.read_through(&*store, file);
  const MissingWork missing = missing_of(stored);
  if (is_mixture(sets) || run.other_instruction_sets == OtherInstructionSets::allowed) {
    sets = all_instruction_sets(sets, stored.instruction_sets());
    if (is_mixture(sets)) store->set_note(instruction_set_note, sets);
  }
  if (!run.command.empty() && !missing.blocks.empty()) {
    store->set_note(command_key(run.command), run.command);
  }
  if (!run.machine.empty() && !missing.blocks.empty()) {
    store->set_note(machine_key(run.machine), run.machine);
  }

  const std::vector<WorkUnit> queries = query_units(missing);
  std::vector<WorkUnit> blocks = block_units(missing);
  if (ranks) ranks->welcome(!blocks.empty());
  if (!blocks.empty() && !run.stop.stop_requested()) computer.prepare_maps();
  record_calibrations(study, work, run, stored, computer.scenes(), store);
  if (!store) return;  // stopped
  ResultRecorder recorder(work, missing, run, *store);
  /// What is wanted next, where results decide how far a cell goes.
  const auto next_blocks = [&] {
    const bool decided = study.file.interval_width || run.first_blocks;
    if (!decided || blocks.empty() || run.stop.stop_requested()) return false;
    stored.add(store->index(), file);
    blocks = block_units(missing_of(stored));
    recorder.expect_blocks(blocks.size());
    return !blocks.empty();
  };
  if (ranks) {
    compute_on_ranks(queries, blocks, computer, run, *ranks, recorder, store);
    while (next_blocks()) compute_on_ranks({}, blocks, computer, run, *ranks, recorder, store);
    return;
  }
  const RaisedThreadLimit raised(run.threads);
  tbb::task_arena arena(run.threads > 0 ? raised.allowed(run.threads) : tbb::task_arena::automatic);
  if (!queries.empty()) {
    recorder.begin_queries();
    compute_here(queries, computer, run, arena, recorder);
  }
  recorder.begin_blocks();
  do {
    compute_here(blocks, computer, run, arena, recorder);
  } while (next_blocks());
}

}  // namespace vernier::sim::internal
