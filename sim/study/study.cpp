// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
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

/// Changes when the meaning of stored results does.
constexpr int results_version = 1;

/// Size of a block that is no part of a cell's key: all stores had it before sizes differed.
constexpr int usual_block = 50;

/// All that a cell's results depend on, as text: the key under which they are stored. Blocks of
/// another size record their maps for other trials, and so are kept under another key.
std::string cell_key(const Study& study, const StudyCell& cell) {
  nlohmann::ordered_json key{{"results", results_version},
                             {"world", study.world_fingerprint},
                             {"rig", study.rig_fingerprint}};
  for (const auto& [name, value] : cell.settings) {
    if (name != "localiser.knows_endpoint_sigma") key[name] = value;
  }
  // Before there was a choice the estimator was told this; results that it still holds for are
  // kept.
  const double once_told = std::max(0.1, cell.experiment.sources.endpoint_sigma_px);
  if (const double told = told_endpoint_sigma_px(cell.experiment); told != once_told) {
    key["localiser.told_endpoint_sigma_px"] = told;
  }
  if (study.file.trials_per_block != usual_block) {
    key["study.trials_per_block"] = study.file.trials_per_block;
  }
  return key.dump();
}

/// What noise-free looks of the map depend on.
std::string looks_key(const ExperimentSettings& s) {
  return fmt::format("{} {} {} {}", s.mount.height_m, s.mount.pitch_rad, s.map_spacing_m,
                     s.map_headings);
}

/// The ceiling is a mean over so many of a cell's queries.
int ceiling_queries(const Study& study) { return std::min(study.file.trials, 200); }

std::string ceiling_key(const Study& study, const ExperimentSettings& s) {
  return fmt::format("ceiling {} {} {} {} {} {} {}", study.world_fingerprint, study.rig_fingerprint,
                     name(s.protocol), s.mount.height_m, s.mount.pitch_rad, s.seed,
                     ceiling_queries(study));
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

/// Jobs of the shard that no store of the folder holds yet.
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

/// The world's ceiling on the first queries of a cell; calls `one_done` after each of them. The
/// sum is in the order of the queries, whichever was done first.
double compute_ceiling(const Study& study,
                       const Visibility& visibility,
                       const ExperimentSettings& settings,
                       tbb::task_arena& arena,
                       const std::function<void()>& one_done) {
  NoiseFreeViewOptions options;
  options.mount = settings.mount;
  const AliasFinder finder(visibility, study.rig.rig, options);
  std::vector<double> of_query(static_cast<std::size_t>(ceiling_queries(study)));
  in_parallel(arena, static_cast<int>(of_query.size()), [&](int i) {
    of_query[i] = finder
                      .aliases(draw_query(visibility, settings.protocol, settings.mount.height_m,
                                          settings.seed, static_cast<std::uint32_t>(i)))
                      .ceiling();
    one_done();
  });
  double sum = 0;
  for (const double ceiling : of_query) sum += ceiling;
  return sum / static_cast<double>(of_query.size());
}

/// Writes the ceilings that the store lacks into it, each as soon as it is known.
void add_ceilings(const Study& study,
                  const Visibility& visibility,
                  const StudyRun& run,
                  tbb::task_arena& arena,
                  StudyStore& store) {
  std::map<std::string, const ExperimentSettings*> missing;
  for (const StudyCell& cell : study.file.cells) {
    const std::string key = ceiling_key(study, cell.experiment);
    if (store.note(key).empty()) missing.emplace(key, &cell.experiment);
  }
  if (missing.empty()) return;
  std::mutex mutex;
  int done = 0;
  const int total = static_cast<int>(missing.size()) * ceiling_queries(study);
  if (run.ceiling_progress) run.ceiling_progress(0, total);
  const auto one_done = [&] {
    const std::lock_guard lock(mutex);
    ++done;
    if (run.ceiling_progress) run.ceiling_progress(done, total);
  };
  for (const auto& [key, settings] : missing) {
    store.set_metadata(
        key, fmt::format("{}", compute_ceiling(study, visibility, *settings, arena, one_done)));
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
                "is not index/count with 0 <= index < count", "");
  }
  std::filesystem::create_directories(run.folder);
  const Visibility visibility(study.world);
  const std::vector<Job> jobs = missing_jobs(study, run);
  StudyStore store(run.folder / store_name(run.shard));
  if (!run.command.empty() && !jobs.empty())
    store.set_metadata(command_key(run.command), run.command);

  tbb::task_arena arena(run.threads > 0 ? run.threads : tbb::task_arena::automatic);
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
  std::map<std::string, std::string> ceilings;
  std::set<std::string> commands;
  for (const auto& file : store_files(folder)) {
    const StudyStore store(file);
    for (StoredBlock& block : store.blocks()) {
      auto& kept = blocks[{block.cell, block.block}];
      kept = longer_block(std::move(block), std::move(kept), file.string());
    }
    for (const StudyCell& cell : study.file.cells) {
      const std::string key = ceiling_key(study, cell.experiment);
      if (const std::string value = store.note(key); !value.empty()) ceilings[key] = value;
    }
    for (const auto& [key, value] : store.notes()) {
      if (key == command_key(value)) commands.insert(value);
    }
  }
  StudyResults results;
  results.commands.assign(commands.begin(), commands.end());
  for (const StudyCell& cell : study.file.cells) {
    CellResult result;
    result.cell = cell;
    result.trials_per_block = study.file.trials_per_block;
    const auto ceiling = ceilings.find(ceiling_key(study, cell.experiment));
    result.ceiling = std::numeric_limits<double>::quiet_NaN();
    if (ceiling != ceilings.end()) {
      result.ceiling = vernier::internal::to_real(ceiling->second).value_or(result.ceiling);
    }
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
