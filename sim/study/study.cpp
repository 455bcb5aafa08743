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
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/study/ceiling.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"
#include "sim/study/told_rig.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Incremented when the meaning of stored results changes.
constexpr int results_version = 1;

/// Block size that is not part of a cell's key: all stores had it before sizes could differ.
constexpr int usual_block = 50;

/// Everything that a cell's results depend on, as text: the key under which they are stored. Blocks
/// of another size use other maps per trial and are therefore stored under another key.
std::string cell_key(const Study& study, const StudyCell& cell) {
  nlohmann::ordered_json key{{"results", results_version},
                             {"world", study.world_fingerprint},
                             {"rig", study.rig_fingerprint}};
  for (const auto& [name, value] : cell.settings) {
    if (name != "localiser.knows_endpoint_sigma") key[name] = value;
  }
  // Older stores had no such setting and this value; their results remain valid.
  const double once_told = std::max(0.1, cell.experiment.sources.endpoint_sigma_px);
  if (const double told = told_endpoint_sigma_px(cell.experiment); told != once_told) {
    key["localiser.told_endpoint_sigma_px"] = told;
  }
  if (study.file.trials_per_block != usual_block) {
    key["study.trials_per_block"] = study.file.trials_per_block;
  }
  return key.dump();
}

/// Everything that the noise-free views of the map depend on.
std::string looks_key(const ExperimentSettings& s) {
  return fmt::format("{} {} {} {}", s.mount.height_m, s.mount.pitch_rad, s.map_spacing_m,
                     s.map_headings);
}

/// The ceiling is the mean over this many of a cell's queries.
int ceiling_queries(const Study& study) { return std::min(study.file.trials, 200); }

std::string ceiling_key(const Study& study, const ExperimentSettings& s) {
  return fmt::format("ceiling {} {} {} {} {} {} {}", study.world_fingerprint, study.rig_fingerprint,
                     name(s.protocol), s.mount.height_m, s.mount.pitch_rad, s.seed,
                     ceiling_queries(study));
}

/// One query's share of a ceiling whose queries are shared among shards.
std::string query_key(const std::string& ceiling, int query) {
  return fmt::format("{} query {}", ceiling, query);
}

using Notes = std::map<std::string, std::string>;

/// The notes of all stores of the folder.
Notes notes_of(const std::filesystem::path& folder) {
  Notes notes;
  for (const auto& file : store_files(folder)) {
    for (const auto& [key, value] : StudyStore(file).notes()) notes[key] = value;
  }
  return notes;
}

/// A number of the notes, not a number where they have none.
double noted(const Notes& notes, const std::string& key) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto found = notes.find(key);
  return found == notes.end() ? nan : vernier::internal::to_real(found->second).value_or(nan);
}

/// What the notes have of a ceiling's queries, not a number for the others.
std::vector<double> noted_queries(const Study& study, const Notes& notes, const std::string& key) {
  std::vector<double> of_query(static_cast<std::size_t>(ceiling_queries(study)));
  for (std::size_t i = 0; i < of_query.size(); ++i) {
    of_query[i] = noted(notes, query_key(key, static_cast<int>(i)));
  }
  return of_query;
}

/// The sum is in the order of the queries, whichever was done first.
double mean(const std::vector<double>& of_query) {
  double sum = 0;
  for (const double ceiling : of_query) sum += ceiling;
  return sum / static_cast<double>(of_query.size());
}

/// Not a number where the notes lack it or one of its queries.
double noted_ceiling(const Study& study, const Notes& notes, const std::string& key) {
  const double whole = noted(notes, key);
  return std::isnan(whole) ? mean(noted_queries(study, notes, key)) : whole;
}

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
std::vector<Job> missing_jobs(const Study& study, const StudyRun& run) {
  std::map<std::pair<std::string, int>, std::size_t> sizes;
  for (const auto& file : store_files(run.folder)) {
    for (const StoredBlock& block : StudyStore(file).blocks()) {
      auto& size = sizes[{block.cell, block.block}];
      size = std::max(size, block.trials.size());
    }
  }
  std::vector<Job> missing;
  const std::vector<Job> jobs = all_jobs(study);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (static_cast<int>(i) % run.shard.count != run.shard.index) continue;
    const auto found = sizes.find({jobs[i].key, jobs[i].block});
    if (found == sizes.end() || static_cast<int>(found->second) < jobs[i].count) {
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

/// Calls work(0) … work(count - 1) on the threads of an arena.
template <class Work>
void in_parallel(tbb::task_arena& arena, int count, Work work) {
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, count, 1),
        [&](const tbb::blocked_range<int>& range) {
          for (int i = range.begin(); i < range.end(); ++i) work(i);
        },
        tbb::simple_partitioner());
  });
}

/// A ceiling that no store of the folder has, and this shard's part of it.
struct MissingCeiling {
  const ExperimentSettings* settings;
  std::vector<double> of_query;  ///< NaN until it is known
  std::vector<int> mine;         ///< the queries to compute
};

/// Computes this shard's queries of a ceiling; calls `one_done` after each of them.
void compute_queries(const Study& study,
                     const Visibility& visibility,
                     MissingCeiling& ceiling,
                     tbb::task_arena& arena,
                     const std::function<void()>& one_done) {
  const ExperimentSettings& settings = *ceiling.settings;
  NoiseFreeViewOptions options;
  options.mount = settings.mount;
  const AliasFinder finder(visibility, study.rig.rig, options);
  in_parallel(arena, static_cast<int>(ceiling.mine.size()), [&](int i) {
    const int query = ceiling.mine[i];
    ceiling.of_query[query] =
        finder
            .aliases(draw_query(visibility, settings.protocol, settings.mount.height_m,
                                settings.seed, static_cast<std::uint32_t>(query)))
            .ceiling();
    one_done();
  });
}

/// Computes the ceilings that no store of the folder has, and stores each as soon as it is known.
/// With other shards, this one computes one of every shard.count queries.
void add_ceilings(const Study& study,
                  const Visibility& visibility,
                  const StudyRun& run,
                  tbb::task_arena& arena,
                  StudyStore& store) {
  const Notes notes = notes_of(run.folder);
  std::map<std::string, MissingCeiling> missing;
  int total = 0;
  for (const StudyCell& cell : study.file.cells) {
    const std::string key = ceiling_key(study, cell.experiment);
    if (missing.count(key) > 0 || !std::isnan(noted_ceiling(study, notes, key))) continue;
    MissingCeiling ceiling{&cell.experiment, noted_queries(study, notes, key), {}};
    for (int i = run.shard.index; i < ceiling_queries(study); i += run.shard.count) {
      if (std::isnan(ceiling.of_query[i])) ceiling.mine.push_back(i);
    }
    total += static_cast<int>(ceiling.mine.size());
    if (!ceiling.mine.empty()) missing.emplace(key, std::move(ceiling));
  }
  if (missing.empty()) return;
  std::mutex mutex;
  int done = 0;
  if (run.ceiling_progress) run.ceiling_progress(0, total);
  const auto one_done = [&] {
    const std::lock_guard lock(mutex);
    ++done;
    if (run.ceiling_progress) run.ceiling_progress(done, total);
  };
  for (auto& [key, ceiling] : missing) {
    compute_queries(study, visibility, ceiling, arena, one_done);
    const double whole = mean(ceiling.of_query);
    if (!std::isnan(whole)) {
      store.set_metadata(key, fmt::format("{}", whole));
      continue;
    }
    for (const int query : ceiling.mine) {
      store.set_metadata(query_key(key, query), fmt::format("{}", ceiling.of_query[query]));
    }
  }
}

std::string store_name(const Shard& shard) {
  return shard.count == 1 ? "results.sqlite"
                          : fmt::format("results-{}-of-{}.sqlite", shard.index, shard.count);
}

}  // namespace

std::string command_key(const std::string& command) { return "command " + command; }

void run_study(const Study& study, const StudyRun& run) {
  if (run.shard.count < 1 || run.shard.index < 0 || run.shard.index >= run.shard.count) {
    throw Error(fmt::format("shard {}/{}", run.shard.index, run.shard.count),
                "not a valid index/count", "use 0 <= index < count");
  }
  std::filesystem::create_directories(run.folder);
  const Visibility visibility(study.world);
  const std::vector<Job> jobs = missing_jobs(study, run);
  StudyStore store(run.folder / store_name(run.shard));
  if (!run.command.empty() && !jobs.empty())
    store.set_metadata(command_key(run.command), run.command);

  const RaisedThreadLimit raised(run.threads);
  tbb::task_arena arena(run.threads > 0 ? raised.allowed(run.threads) : tbb::task_arena::automatic);
  add_ceilings(study, visibility, run, arena, store);

  std::map<std::string, std::shared_ptr<const MapViews>> looks;
  for (const StudyCell& cell : study.file.cells) {
    auto& shared = looks[looks_key(cell.experiment)];
    if (!shared && !jobs.empty()) {
      shared = std::make_shared<MapViews>(map_views(visibility, study.rig.rig, cell.experiment));
    }
  }

  std::mutex mutex;
  int done = 0;
  const auto total = static_cast<int>(jobs.size());
  if (run.progress) run.progress(0, total);
  const auto do_job = [&](int i) {
    const Job& job = jobs[i];
    const LocalisationExperiment experiment(
        visibility, study.rig, looks.at(looks_key(job.cell->experiment)), job.cell->experiment);
    StoredBlock block{job.key, job.block,
                      experiment.run_block({.block = static_cast<std::uint32_t>(job.block),
                                            .first = static_cast<std::uint32_t>(job.first),
                                            .count = static_cast<std::uint32_t>(job.count)})};
    const std::lock_guard lock(mutex);
    store.put(block);
    if (run.progress) run.progress(++done, total);
  };
  in_parallel(arena, total, do_job);
}

StudyResults study_results(const Study& study, const std::filesystem::path& folder) {
  std::map<std::pair<std::string, int>, StoredBlock> blocks;
  Notes notes;
  std::set<std::string> commands;
  for (const auto& file : store_files(folder)) {
    const StudyStore store(file);
    for (StoredBlock& block : store.blocks()) {
      auto& kept = blocks[{block.cell, block.block}];
      kept = longer_block(std::move(block), std::move(kept), file.string());
    }
    for (const auto& [key, value] : store.notes()) {
      notes[key] = value;
      if (key == command_key(value)) commands.insert(value);
    }
  }
  StudyResults results;
  results.commands.assign(commands.begin(), commands.end());
  for (const StudyCell& cell : study.file.cells) {
    CellResult result;
    result.cell = cell;
    result.trials_per_block = study.file.trials_per_block;
    result.ceiling = noted_ceiling(study, notes, ceiling_key(study, cell.experiment));
    results.cells.push_back(std::move(result));
  }
  for (const Job& job : all_jobs(study)) {
    ++results.blocks_total;
    const auto found = blocks.find({job.key, job.block});
    if (found == blocks.end() || static_cast<int>(found->second.trials.size()) < job.count) {
      continue;
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
