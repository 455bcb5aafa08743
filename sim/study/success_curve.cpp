// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/success_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "localise/localiser.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/study/idle_settings.h"
#include "sim/study/study.h"
#include "sim/study/study_file.h"
#include "sim/study/study_work.h"
#include "sim/study/success_interval.h"
#include "sim/study/system_kind.h"
#include "sim/study/work_units.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Where a line through (x0, y0) and (x1, y1) is at y.
double crossing(double x0, double y0, double x1, double y1, double y) {
  return y0 == y1 ? x0 : x0 + (x1 - x0) * (y0 - y) / (y0 - y1);
}

/// The largest x at which a falling curve is at `level` or above; -1 if it never is.
double last_above(const std::vector<SuccessAt>& curve,
                  const std::vector<double>& falling,
                  double level) {
  if (falling[0] < level) return -1;
  for (std::size_t i = 1; i < falling.size(); ++i) {
    if (falling[i] >= level) continue;
    return crossing(curve[i - 1].psi_c, falling[i - 1], curve[i].psi_c, falling[i], level);
  }
  return curve.back().psi_c;
}

/// Pools neighbours that rise until none does.
std::vector<double> isotonic(const std::vector<SuccessAt>& curve) {
  std::vector<std::pair<double, int>> pools;  // mean and number
  for (const SuccessAt& at : curve) {
    pools.emplace_back(at.success, 1);
    while (pools.size() > 1 && pools[pools.size() - 2].first < pools.back().first) {
      const auto [mean, count] = pools.back();
      pools.pop_back();
      auto& [other, others] = pools.back();
      other = (other * others + mean * count) / (others + count);
      others += count;
    }
  }
  std::vector<double> values;
  for (const auto& [mean, count] : pools) values.insert(values.end(), std::size_t(count), mean);
  return values;
}

/// A cell with another size of a source.
StudyCell with_source(const StudyCell& cell,
                      std::string_view name,
                      double SourceSettings::*value,
                      double size) {
  StudyCell other = cell;
  other.experiment.sources.*value = size;
  other.settings[fmt::format("sources.{}", name)] = fmt::format("{}", size);
  return other;
}

/// What became of the trials of a block.
struct BlockCount {
  ClusterCount count;
  int failed = 0;
  std::string why_failed = {};
};

BlockCount block_count(const StudyCell& cell, std::vector<TrialResult> trials) {
  apply_limit(cell, trials);
  BlockCount block{.count = count_of(trials)};
  for (const TrialResult& trial : trials) {
    if (trial.status != localise::LocalisationStatus::failed) continue;
    if (block.failed++ == 0) block.why_failed = trial.failure;
  }
  return block;
}

/// How often the trials of each cell succeed. Cells differ in sources only.
std::vector<SuccessAt> success_of_cells(const Study& study, const SuccessCurveOptions& options) {
  const StudyWork work = study_work(study);
  UnitComputer computer(study, work);
  computer.prepare_maps();
  std::vector<BlockCount> of_block(work.blocks.size());
  std::mutex mutex;
  int done = 0;
  for_each_index(work.blocks.size(), options.threads, [&](std::size_t i) {
    const BlockJob& job = work.blocks[i];
    of_block[i] =
        block_count(study.file.cells[static_cast<std::size_t>(job.cell)], computer.trials(job));
    const std::lock_guard lock(mutex);
    if (options.progress) options.progress(++done, static_cast<int>(of_block.size()));
  });
  std::vector<SuccessAt> successes;
  for (std::size_t k = 0; k < study.file.cells.size(); ++k) {
    SuccessAt at{.psi_c = study.file.cells[k].experiment.sources.calibration};
    std::vector<ClusterCount> counts;
    int right = 0, trials = 0;
    for (std::size_t i = 0; i < of_block.size(); ++i) {
      if (work.blocks[i].cell != work.same_as[k]) continue;
      const BlockCount& block = of_block[i];
      counts.push_back(block.count);
      right += block.count.successes;
      trials += block.count.trials;
      if (at.failed == 0) at.why_failed = block.why_failed;
      at.failed += block.failed;
    }
    at.success = static_cast<double>(right) / trials;
    if (const auto interval = clustered_interval_95(counts)) at.interval_95 = *interval;
    successes.push_back(std::move(at));
  }
  return successes;
}

}  // namespace

std::vector<SuccessAt> success_curve(Study study, const SuccessCurveOptions& options) {
  std::vector<StudyCell> cells;
  for (const double psi_c : options.psi_c) {
    cells.push_back(
        with_source(study.file.cells[0], "calibration", &SourceSettings::calibration, psi_c));
  }
  study.file.cells = std::move(cells);
  return success_of_cells(study, options);
}

std::vector<SuccessAt> success_curve_about(const Study& study,
                                           double success,
                                           const SuccessCurveOptions& options) {
  constexpr int most_rounds = 8;
  std::vector<SuccessAt> curve = success_curve(study, options);
  for (int round = 0; round < most_rounds; ++round) {
    SuccessCurveOptions between = options;
    between.psi_c = scales_between(curve, success);
    if (between.psi_c.empty()) break;
    for (SuccessAt& at : success_curve(study, between)) curve.push_back(std::move(at));
    std::sort(curve.begin(), curve.end(),
              [](const SuccessAt& a, const SuccessAt& b) { return a.psi_c < b.psi_c; });
  }
  return curve;
}

std::vector<double> scales_between(const std::vector<SuccessAt>& curve, double success) {
  constexpr double close = 1.25, smallest = 1.0 / 64;
  const ScaleNeeded needed = scale_needed(curve, success);
  std::set<double> between;
  for (const double crossing : {needed.low, needed.psi_c, needed.high}) {
    const auto above = std::find_if(curve.begin(), curve.end(),
                                    [&](const SuccessAt& at) { return at.psi_c > crossing; });
    if (!(crossing > 0) || above == curve.begin() || above == curve.end()) continue;
    const double low = std::prev(above)->psi_c, high = above->psi_c;
    if (low == 0 && high > smallest) between.insert(high / 2);
    if (low > 0 && high > close * low) between.insert(std::sqrt(low * high));
  }
  return {between.begin(), between.end()};
}

ScaleNeeded scale_needed(const std::vector<SuccessAt>& curve, double success) {
  if (curve.empty()) throw Error("success curve", "has no scales", "give at least one");
  std::vector<double> upper, lower(curve.size());
  for (const SuccessAt& at : curve) {
    upper.push_back(upper.empty() ? at.interval_95.high
                                  : std::min(upper.back(), at.interval_95.high));
  }
  for (std::size_t i = curve.size(); i-- > 0;) {
    lower[i] = i + 1 == curve.size() ? curve[i].interval_95.low
                                     : std::max(lower[i + 1], curve[i].interval_95.low);
  }
  const std::vector<double> rate = isotonic(curve);
  ScaleNeeded needed;
  needed.psi_c = std::max(0.0, last_above(curve, rate, success));
  needed.low = std::clamp(last_above(curve, lower, success), 0.0, needed.psi_c);
  needed.high = std::max(needed.psi_c, last_above(curve, upper, success));
  needed.beyond = rate.back() >= success;
  return needed;
}

std::vector<LimitingCause> limiting_causes(Study study, const SuccessCurveOptions& options) {
  if (system_of(study.file).sources != SourcesUsed::all) return {};
  const StudyCell now =
      with_source(study.file.cells[0], "calibration", &SourceSettings::calibration, 0);
  const SourceSettings& sources = now.experiment.sources;
  std::vector<LimitingCause> causes;
  std::vector<StudyCell> cells;
  for (const SourceParameter& parameter : source_parameters()) {
    if (parameter.name == "calibration" || !parameter.is_switch ||
        !(sources.*parameter.value > 0) || !why_idle(key_of(parameter), now).empty()) {
      continue;
    }
    causes.push_back({std::string(parameter.name)});
    cells.push_back(with_source(now, parameter.name, parameter.value, 0));
  }
  for (std::size_t i = 0; i < sources.own.size(); ++i) {
    causes.push_back({sources.own[i].name});
    StudyCell& without = cells.emplace_back(now);
    auto& own = without.experiment.sources.own;
    own.erase(own.begin() + static_cast<std::ptrdiff_t>(i));
    without.settings["sources.own"] += " without " + sources.own[i].name;  // another cell
  }
  if (!sources.command.empty()) {
    causes.push_back({"command"});
    StudyCell& without = cells.emplace_back(now);
    without.experiment.sources.command.clear();
    without.settings.erase("sources.command");
  }
  if (causes.empty()) return {};
  study.file.cells = std::move(cells);
  const std::vector<SuccessAt> without = success_of_cells(study, options);
  for (std::size_t i = 0; i < causes.size(); ++i) causes[i].success = without[i].success;
  std::stable_sort(causes.begin(), causes.end(),
                   [](const auto& a, const auto& b) { return a.success > b.success; });
  return causes;
}

}  // namespace vernier::sim::internal
