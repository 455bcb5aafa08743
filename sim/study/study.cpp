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
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <utility>

#include "calib/base/error_place.h"
#include "calib/base/instruction_set.h"
#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/study/ceiling.h"
#include "sim/study/stored_results.h"
#include "sim/study/study_file.h"
#include "sim/study/study_keys.h"
#include "sim/study/study_scenes.h"
#include "sim/study/study_store.h"
#include "sim/told/fresh_calibrations.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

struct Job {
  const StudyCell* cell;
  std::string key;
  int block, first, count;
};

std::vector<Job> all_jobs(const Study& study) {
  std::vector<Job> jobs;
  for (const StudyCell& cell : study.file.cells) {
    const std::string key = cell_key(study, cell);
    const int size = study.file.trials_per_block;
    for (int first = 0, block = 0; first < study.file.trials; first += size, ++block) {
      jobs.push_back({&cell, key, block, first, std::min(size, study.file.trials - first)});
    }
  }
  return jobs;
}

/// Jobs of the shard that are in no store of the folder yet.
std::vector<Job> missing_jobs(const Study& study,
                              const StudyRun& run,
                              const StoredResults& stored) {
  std::vector<Job> missing;
  const std::vector<Job> jobs = all_jobs(study);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (static_cast<int>(i % static_cast<std::size_t>(run.shard.count)) != run.shard.index) {
      continue;
    }
    const auto found = stored.blocks.find({jobs[i].key, jobs[i].block});
    if (found == stored.blocks.end() ||
        static_cast<int>(found->second.trials.size()) < jobs[i].count) {
      missing.push_back(jobs[i]);
    }
  }
  return missing;
}

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

/// Calls work(0) … work(count - 1) on the threads of an arena. `finished` orders what they did
/// before what follows, as the end of the loop does: the thread sanitizer does not see into TBB.
template <class Work>
void in_parallel(tbb::task_arena& arena, int count, Work work) {
  std::atomic<int> finished = 0;
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, count, 1),
        [&](const tbb::blocked_range<int>& range) {
          for (int i = range.begin(); i < range.end(); ++i) {
            work(i);
            finished.fetch_add(1, std::memory_order_release);
          }
        },
        tbb::simple_partitioner());
  });
  [[maybe_unused]] const int ended = finished.load(std::memory_order_acquire);
}

/// A ceiling that no store of the folder has, and this shard's part of it.
struct MissingCeiling {
  const StudyCell* cell;
  std::vector<int> of_query;  ///< as ceiling_part() stores them
  std::vector<int> mine;      ///< the queries to compute
};

/// Computes this shard's queries of a ceiling until asked to stop, and stores them some hundred at
/// a time under the ceiling's key; calls `one_done` after each.
void compute_queries(const AliasFinder& finder,
                     const QueryPlaces& places,
                     const std::string& key,
                     const MissingCeiling& ceiling,
                     tbb::task_arena& arena,
                     const std::stop_token& stop,
                     const std::function<void()>& one_done,
                     StudyStore& store) {
  constexpr std::size_t at_a_time = 500;
  for (std::size_t first = 0; first < ceiling.mine.size(); first += at_a_time) {
    const std::size_t count = std::min(at_a_time, ceiling.mine.size() - first);
    std::vector<int> of_query(ceiling.of_query.size(), not_known);
    in_parallel(arena, static_cast<int>(count), [&](int i) {
      if (stop.stop_requested()) return;
      const int query = ceiling.mine[first + static_cast<std::size_t>(i)];
      const Aliases found = finder.aliases(
          places.draw(ceiling.cell->experiment.seed, static_cast<std::uint32_t>(query)));
      of_query[query] = found.determined ? found.elsewhere : not_determined;
      one_done();
    });
    const auto [part, text] = ceiling_part(key, of_query);
    if (!text.empty()) store.set_note(part, text);
    if (stop.stop_requested()) return;
  }
}

/// With other shards, this one computes one of every shard.count queries.
std::map<std::string, MissingCeiling> missing_ceilings(const Study& study,
                                                       const StudyRun& run,
                                                       const StoreNotes& notes) {
  std::map<std::string, MissingCeiling> missing;
  for (const StudyCell& cell : study.file.cells) {
    const std::string key = ceiling_key(study, cell);
    if (missing.count(key) > 0) continue;
    MissingCeiling ceiling{&cell, noted_queries(study, notes, key), {}};
    for (int i = run.shard.index; i < ceiling_queries(study, key); i += run.shard.count) {
      if (ceiling.of_query[i] == not_known) ceiling.mine.push_back(i);
    }
    if (!ceiling.mine.empty()) missing.emplace(key, std::move(ceiling));
  }
  return missing;
}

/// Computes ceilings, one after the other.
void add_ceilings(const Study& study,
                  const StudyRun& run,
                  StudyScenes& scenes,
                  std::map<std::string, MissingCeiling> missing,
                  tbb::task_arena& arena,
                  StudyStore& store) {
  if (missing.empty()) return;
  int total = 0;
  for (const auto& [key, ceiling] : missing) total += static_cast<int>(ceiling.mine.size());
  std::mutex mutex;
  int done = 0;
  if (run.ceiling_progress) run.ceiling_progress(0, total);
  const auto one_done = [&] {
    const std::lock_guard lock(mutex);
    ++done;
    if (run.ceiling_progress) run.ceiling_progress(done, total);
  };
  for (const auto& [key, ceiling] : missing) {
    NoiseFreeViewOptions options;
    options.mount = ceiling.cell->experiment.mount;
    const QueryWorld world = scenes.queries(*ceiling.cell);
    const AliasFinder finder(
        world.changed ? world.changed->visibility : scenes.visibility(*ceiling.cell), study.rig.rig,
        options);
    compute_queries(finder, *world.places, key, ceiling, arena, run.stop, one_done, store);
  }
}

/// Throws Error if the folder's results are of another kind of processor than this one.
void check_processor(const StoredResults& stored, const std::filesystem::path& folder) {
  const auto there = stored.notes.find("instruction_set");
  if (there == stored.notes.end() || there->second == instruction_set()) return;
  throw Error(folder.string(),
              fmt::format("written with instruction set {}, this processor has {}: results would "
                          "not be identical",
                          shortened(there->second), instruction_set()),
              "continue in another folder");
}

/// Throws Error if a cell cannot be run, before anything is written.
void check_cells(const Study& study, StudyScenes& scenes) {
  for (const StudyCell& cell : study.file.cells) {
    StudyCell still = cell;
    still.experiment.sources.moved = 0;  // a changed world takes time
    const LocalisationExperiment tried(scenes.visibility(cell), study.rig, nullptr,
                                       still.experiment, scenes.queries(still).places, nullptr,
                                       scenes.told(cell));
  }
}

/// Of the first trials of each cell with [calibration], which use the same calibrations.
void record_calibrations(const Study& study,
                         StudyScenes& scenes,
                         const StoredResults& stored,
                         const StudyRun& run,
                         StudyStore& store) {
  std::set<std::string> recorded;
  for (const StudyCell& cell : study.file.cells) {
    const auto calibrations = scenes.calibrations(cell);
    if (!calibrations || run.stop.stop_requested()) continue;
    const std::string key = calibration_key(study, cell);
    if (stored.notes.count(key) > 0 || !recorded.insert(key).second) continue;
    constexpr int enough = 100;
    const auto [name, note] = calibration_note(key, record_of(*calibrations, enough));
    store.set_note(name, note);
  }
}

/// Runs the blocks and stores each as soon as it is done.
void run_jobs(const Study& study,
              StudyScenes& scenes,
              const StudyRun& run,
              const std::vector<Job>& jobs,
              tbb::task_arena& arena,
              StudyStore& store) {
  std::map<std::string, std::shared_ptr<const MapViews>> looks;
  for (const StudyCell& cell : study.file.cells) {
    auto& shared = looks[looks_key(cell)];
    if (!shared && !jobs.empty() && !run.stop.stop_requested()) {
      shared = std::make_shared<MapViews>(with_errors_of(cell.world, [&] {
        return map_views(scenes.visibility(cell), study.rig.rig, cell.experiment);
      }));
    }
  }
  std::mutex mutex;
  int done = 0;
  const auto total = static_cast<int>(jobs.size());
  if (run.progress) run.progress(0, total);
  const auto do_job = [&](int i) {
    if (run.stop.stop_requested()) return;
    const Job& job = jobs[i];
    const StudyCell& cell = *job.cell;
    const QueryWorld world = scenes.queries(cell);
    const LocalisationExperiment experiment(scenes.visibility(cell), study.rig,
                                            looks.at(looks_key(cell)), cell.experiment,
                                            world.places, world.changed, scenes.told(cell));
    const TrialBlock trials{.block = static_cast<std::uint32_t>(job.block),
                            .first = static_cast<std::uint32_t>(job.first),
                            .count = static_cast<std::uint32_t>(job.count)};
    const StoredBlock block{job.key, job.block, with_errors_of(cell.world, [&] {
                              return experiment.run_block(trials);
                            })};
    const std::lock_guard lock(mutex);
    store.put(block);
    if (run.progress) run.progress(++done, total);
  };
  in_parallel(arena, total, do_job);
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
  StoredResults stored = stored_results(run.folder);
  if (missing_jobs(study, run, stored).empty() &&
      missing_ceilings(study, run, stored.notes).empty()) {
    if (run.progress) run.progress(0, 0);
    return;
  }
  check_processor(stored, run.folder);
  StudyScenes scenes(study);
  check_cells(study, scenes);

  std::filesystem::create_directories(run.folder);
  const std::filesystem::path file = store_file(run.folder, run.shard);
  StudyStore store(file);
  if (run.on_start) run.on_start();
  stored.add(store.content(), file);  // it may have been written meanwhile
  const std::vector<Job> jobs = missing_jobs(study, run, stored);
  if (!run.command.empty() && !jobs.empty()) store.set_note(command_key(run.command), run.command);

  const RaisedThreadLimit raised(run.threads);
  tbb::task_arena arena(run.threads > 0 ? raised.allowed(run.threads) : tbb::task_arena::automatic);
  record_calibrations(study, scenes, stored, run, store);
  add_ceilings(study, run, scenes, missing_ceilings(study, run, stored.notes), arena, store);
  run_jobs(study, scenes, run, jobs, arena, store);
}

StudyResults study_results(const Study& study, const std::filesystem::path& folder) {
  const StoredResults stored = stored_results(folder);
  stored.require_all_read();
  const auto& [blocks, notes, none] = stored;
  std::set<std::string> commands;
  for (const auto& [key, value] : notes) {
    if (key == command_key(value)) commands.insert(value);
  }
  StudyResults results;
  results.commands.assign(commands.begin(), commands.end());
  for (const StudyCell& cell : study.file.cells) {
    CellResult result;
    result.cell = cell;
    result.trials_per_block = study.file.trials_per_block;
    result.ceiling = noted_ceiling(study, notes, ceiling_key(study, cell));
    if (cell.told.calibration) {
      result.calibrations = noted_calibrations(notes, calibration_key(study, cell));
    }
    results.cells.push_back(std::move(result));
  }
  for (const Job& job : all_jobs(study)) {
    ++results.blocks_total;
    const auto found = blocks.find({job.key, job.block});
    if (found == blocks.end() || static_cast<int>(found->second.trials.size()) < job.count) {
      continue;
    }
    if (found->second.trials[0].trial != static_cast<std::uint32_t>(job.first)) {
      throw Error(folder.string(), fmt::format("block {} holds other trials", job.block),
                  "delete the stores of the folder and run the study again");
    }
    ++results.blocks_done;
    CellResult& cell = results.cells[job.cell - study.file.cells.data()];
    ClusterCount map;
    for (int i = 0; i < job.count; ++i) {
      cell.trials.push_back(found->second.trials[i]);
      map.successes += found->second.trials[i].success();
      ++map.trials;
    }
    cell.maps.push_back(map);
  }
  return results;
}

}  // namespace vernier::sim::internal
