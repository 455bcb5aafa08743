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
#include <optional>
#include <set>
#include <utility>

#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/quantile.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/study/ceiling.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"
#include "sim/study/success_interval.h"
#include "sim/study/told_rig.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using namespace localise;

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

/// Not a number of none.
double quantile_or_nan(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return quantile(std::move(values), p, QuantileKind::linear);
}

std::map<std::uint32_t, const TrialResult*> by_number(const CellResult& cell) {
  std::map<std::uint32_t, const TrialResult*> trials;
  for (const TrialResult& trial : cell.trials) trials[trial.trial] = &trial;
  return trials;
}

/// McNemar's exact p-value: the smaller count under Binomial(both counts, 1/2), both tails.
double exact_mcnemar(int only_a, int only_b) {
  const int discordant = only_a + only_b;
  if (discordant == 0) return 1;
  return std::min(1.0, 2 * binomial_cdf(std::min(only_a, only_b), discordant, 0.5));
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

CellSummary summarise(const CellResult& cell) {
  constexpr double degree = 0.017453292519943295;
  CellSummary s;
  s.trials = static_cast<int>(cell.trials.size());
  s.maps = static_cast<int>(cell.maps.size());
  int successes = 0, answered = 0, node = 0, close = 0, closer = 0;
  std::vector<double> errors, headings, cpu;
  double wall = 0;
  for (const TrialResult& t : cell.trials) {
    cpu.push_back(t.cpu_ms);
    wall += t.wall_ms;
    if (!t.answered()) continue;
    ++answered;
    const double turn = std::abs(t.heading_error_rad);
    successes += t.success();
    node += t.node_error_m <= 1;
    close += t.error_m <= 0.5 && turn <= 5 * degree;
    closer += t.error_m <= 0.25 && turn <= 2 * degree;
    errors.push_back(t.error_m);
    headings.push_back(turn);
  }
  const double n = std::max(1, s.trials);
  s.success = successes / n;
  s.success_interval_binomial_95 = wilson_interval(successes, s.trials);
  s.success_interval_95 = clustered_interval_95(cell.maps);
  if (!s.success_interval_95) {
    s.why_no_interval = fmt::format("needs {} maps, has {}", fewest_maps, s.maps);
  }
  s.coverage = answered / n;
  s.success_when_answered = answered > 0 ? static_cast<double>(successes) / answered : 0;
  s.node_success = node / n;
  s.recall_05 = close / n;
  s.recall_025 = closer / n;
  s.median_error_m = quantile_or_nan(errors, 0.5);
  s.median_heading_error_rad = quantile_or_nan(headings, 0.5);
  for (const double ms : cpu) s.cpu_ms_mean += ms / n;
  s.cpu_ms_median = quantile_or_nan(cpu, 0.5);
  s.cpu_ms_p95 = quantile_or_nan(cpu, 0.95);
  s.wall_ms_mean = wall / n;
  return s;
}

bool share_queries(const CellResult& a, const CellResult& b) {
  const std::map<std::uint32_t, const TrialResult*> trials_of_a = by_number(a);
  bool shared = false;
  for (const TrialResult& trial : b.trials) {
    const auto found = trials_of_a.find(trial.trial);
    if (found == trials_of_a.end()) continue;
    const Pose2D &p = found->second->truth, &q = trial.truth;
    if (p.x_m != q.x_m || p.y_m != q.y_m || p.heading_rad != q.heading_rad) return false;
    shared = true;
  }
  return shared;
}

PairedComparison compare(const CellResult& a, const CellResult& b) {
  if (!share_queries(a, b)) {
    throw Error("comparison of \"" + a.cell.label + "\" with \"" + b.cell.label + "\"",
                "the cells have no queries in common, or asked in different places",
                "compare cells of one protocol and seed");
  }
  const std::map<std::uint32_t, const TrialResult*> trials_of_a = by_number(a);
  PairedComparison c;
  std::map<std::uint32_t, MapDifference> by_map;
  for (const TrialResult& trial : b.trials) {
    const auto found = trials_of_a.find(trial.trial);
    if (found == trials_of_a.end()) continue;
    const bool in_a = found->second->success(), in_b = trial.success();
    (in_a ? (in_b ? c.both : c.only_a) : (in_b ? c.only_b : c.neither))++;
    MapDifference& map = by_map[trial.trial / static_cast<std::uint32_t>(a.trials_per_block)];
    map.difference += in_a - in_b;
    map.discordant += in_a != in_b;
    ++map.trials;
  }
  std::vector<MapDifference> maps;
  for (const auto& [block, map] : by_map) maps.push_back(map);
  c.maps = static_cast<int>(maps.size());
  if (const std::optional<double> p = paired_p_value(maps)) {
    c.p_value = *p;
    c.mcnemar_p = exact_mcnemar(c.only_a, c.only_b);
  }
  return c;
}

std::vector<std::pair<std::size_t, std::size_t>> comparable_pairs(
    const std::vector<CellResult>& cells) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t b = 1; b < cells.size(); ++b) {
    for (std::size_t a = b; a-- > 0;) {
      if (!share_queries(cells[a], cells[b])) continue;
      pairs.emplace_back(a, b);
      break;
    }
  }
  return pairs;
}

}  // namespace vernier::sim::internal
