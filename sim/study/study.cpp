// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/study.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
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
#include "calib/statistics/quantile.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/query_protocol.h"
#include "sim/study/ceiling.h"
#include "sim/study/study_file.h"
#include "sim/study/study_store.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using namespace localise;

namespace {

/// Changes when the meaning of stored results does.
constexpr int results_version = 1;

/// All that a cell's results depend on, as text: the key under which they are stored.
std::string cell_key(const Study& study, const StudyCell& cell) {
  nlohmann::ordered_json key{{"results", results_version},
                             {"world", study.world_fingerprint},
                             {"rig", study.rig_fingerprint}};
  for (const auto& [name, value] : cell.settings) key[name] = value;
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
    for (int first = 0, block = 0; first < study.file.trials; first += trials_per_block, ++block) {
      jobs.push_back(
          {&cell, key, block, first, std::min(trials_per_block, study.file.trials - first)});
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

/// The world's ceiling on the first queries of a cell.
double compute_ceiling(const Study& study,
                       const Visibility& visibility,
                       const ExperimentSettings& settings) {
  NoiseFreeViewOptions options;
  options.mount = settings.mount;
  const AliasFinder finder(visibility, study.rig.rig, options);
  const int queries = ceiling_queries(study);
  double sum = 0;
  for (int i = 0; i < queries; ++i) {
    sum += finder
               .aliases(draw_query(visibility, settings.protocol, settings.mount.height_m,
                                   settings.seed, static_cast<std::uint32_t>(i)))
               .ceiling();
  }
  return sum / queries;
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

  std::map<std::string, std::shared_ptr<const MapViews>> looks;
  std::set<std::string> ceilings;
  for (const StudyCell& cell : study.file.cells) {
    auto& shared = looks[looks_key(cell.experiment)];
    if (!shared && !jobs.empty()) {
      shared = std::make_shared<MapViews>(map_views(visibility, study.rig.rig, cell.experiment));
    }
    const std::string key = ceiling_key(study, cell.experiment);
    if (ceilings.insert(key).second && store.note(key).empty()) {
      store.set_metadata(key,
                         fmt::format("{}", compute_ceiling(study, visibility, cell.experiment)));
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
                      experiment.run_block(static_cast<std::uint32_t>(job.block),
                                           static_cast<std::uint32_t>(job.first),
                                           static_cast<std::uint32_t>(job.count))};
    const std::lock_guard lock(mutex);
    store.put(block);
    if (run.progress) run.progress(++done, total);
  };
  tbb::task_arena arena(run.threads > 0 ? run.threads : tbb::task_arena::automatic);
  const tbb::global_control limit(
      tbb::global_control::max_allowed_parallelism,
      run.threads > 0
          ? run.threads
          : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, total, 1),
        [&](const tbb::blocked_range<int>& range) {
          for (int i = range.begin(); i < range.end(); ++i) do_job(i);
        },
        tbb::simple_partitioner());
  });
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
  const double effective = s.trials / design_effect(cell.maps);
  s.success_interval_95 = wilson_interval(s.success * effective, effective);
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

PairedComparison compare(const CellResult& a, const CellResult& b) {
  std::map<std::uint32_t, bool> success_of_a;
  for (const TrialResult& trial : a.trials) success_of_a[trial.trial] = trial.success();
  PairedComparison c;
  for (const TrialResult& trial : b.trials) {
    const auto found = success_of_a.find(trial.trial);
    if (found == success_of_a.end()) continue;
    const bool in_a = found->second, in_b = trial.success();
    (in_a ? (in_b ? c.both : c.only_a) : (in_b ? c.only_b : c.neither))++;
  }
  // Exact: the smaller count under Binomial(discordant, 1/2), both tails.
  const int discordant = c.only_a + c.only_b, fewer = std::min(c.only_a, c.only_b);
  double log_term = -discordant * std::log(2.0), tail = 0;
  for (int k = 0; k <= fewer; ++k) {
    tail += std::exp(log_term);
    log_term += std::log(static_cast<double>(discordant - k)) - std::log(k + 1.0);
  }
  c.mcnemar_p = discordant > 0 ? std::min(1.0, 2 * tail) : 1;
  return c;
}

}  // namespace vernier::sim::internal
