// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/success_curve.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>

#include "calib/base/ordered_parallel.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/study/study_file.h"
#include "sim/study/success_interval.h"
#include "sim/told_rigs.h"
#include "sim/visibility.h"

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

}  // namespace

std::vector<SuccessAt> success_curve(const Visibility& visibility,
                                     const Rig& truth,
                                     const Covariance& covariance,
                                     const ExperimentSettings& settings,
                                     const SuccessCurveOptions& options) {
  const int size = block_size(options.trials);
  const int blocks = (options.trials + size - 1) / size;
  RigEstimate rig;
  rig.rig = truth;
  const auto views = std::make_shared<const MapViews>(map_views(visibility, truth, settings));
  std::vector<std::unique_ptr<const LocalisationExperiment>> experiments;
  for (const double psi_c : options.psi_c) {
    ExperimentSettings scaled = settings;
    scaled.sources.calibration = psi_c;
    experiments.push_back(std::make_unique<const LocalisationExperiment>(
        visibility, rig, views, scaled, nullptr, nullptr,
        drawn_rigs(truth, covariance, psi_c, settings.seed, "plan")));
  }
  const int total = blocks * static_cast<int>(experiments.size());
  std::vector<ClusterCount> counts(static_cast<std::size_t>(total));
  std::mutex mutex;
  int done = 0;
  for_each_index(counts.size(), options.threads, [&](std::size_t i) {
    const int block = static_cast<int>(i) % blocks, first = block * size;
    const auto trials = experiments[i / static_cast<std::size_t>(blocks)]->run_block(
        {static_cast<std::uint32_t>(block), static_cast<std::uint32_t>(first),
         static_cast<std::uint32_t>(std::min(size, options.trials - first))});
    const auto right = std::count_if(trials.begin(), trials.end(),
                                     [](const TrialResult& t) { return t.success(); });
    counts[i] = {static_cast<int>(right), static_cast<int>(trials.size())};
    const std::lock_guard lock(mutex);
    if (options.progress) options.progress(++done, total);
  });
  std::vector<SuccessAt> curve;
  for (std::size_t k = 0; k < options.psi_c.size(); ++k) {
    const std::span maps(counts.data() + k * static_cast<std::size_t>(blocks),
                         static_cast<std::size_t>(blocks));
    int right = 0;
    for (const ClusterCount& map : maps) right += map.successes;
    SuccessAt at{options.psi_c[k], static_cast<double>(right) / options.trials, {0, 1}};
    if (const auto interval = clustered_interval_95(maps)) at.interval_95 = *interval;
    curve.push_back(at);
  }
  return curve;
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
  needed.low = std::max(0.0, last_above(curve, lower, success));
  needed.high = last_above(curve, upper, success);
  needed.beyond = rate.back() >= success;
  return needed;
}

std::vector<LimitingCause> limiting_causes(const Visibility& visibility,
                                           const Rig& truth,
                                           const Covariance& covariance,
                                           const ExperimentSettings& settings,
                                           SuccessCurveOptions options) {
  options.psi_c = {0};
  std::vector<LimitingCause> causes;
  for (const SourceParameter& parameter : source_parameters()) {
    const bool of_corners = parameter.name.starts_with("corner");
    if (parameter.name == "calibration" || !parameter.is_switch ||
        !(settings.sources.*parameter.value > 0) ||
        (of_corners && !localise::needs_corners(settings.method, settings.localiser))) {
      continue;
    }
    ExperimentSettings without = settings;
    without.sources.*parameter.value = 0;
    causes.push_back({std::string(parameter.name),
                      success_curve(visibility, truth, covariance, without, options)[0].success});
  }
  std::stable_sort(causes.begin(), causes.end(),
                   [](const auto& a, const auto& b) { return a.success > b.success; });
  return causes;
}

}  // namespace vernier::sim::internal
