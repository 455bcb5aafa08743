// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/cell_tally.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/quantile.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/block_outcomes.h"
#include "sim/study/budget.h"
#include "sim/study/cell_summary.h"
#include "sim/study/study.h"
#include "sim/study/success_interval.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using namespace localise;

namespace {

/// NaN if there are none.
double quantile_or_nan(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return quantile(std::move(values), p, QuantileKind::linear);
}

/// Of the values that are known.
MeasuredSummary quantity_of(std::vector<double>& values) {
  MeasuredSummary summary;
  summary.trials = static_cast<int>(values.size());
  if (values.empty()) return summary;
  double sum = 0, squares = 0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  summary.mean = sum / n;
  summary.rms = std::sqrt(squares / n);
  summary.median = quantile(std::move(values), 0.5, QuantileKind::linear);
  return summary;
}

}  // namespace

void CellTally::add(const TrialResult& t) {
  constexpr double degree = std::numbers::pi / 180;
  ++cell_.summary.trials;
  cpu_ms_ += t.cpu_ms;
  cpus_ms_.push_back(t.cpu_ms);
  wall_ms_ += t.wall_ms;
  guesses_ += t.error <= t.limit;
  cell_.summary.unseen += t.status == LocalisationStatus::too_few_lines ||
                          t.status == LocalisationStatus::too_few_corners;
  if (t.status == LocalisationStatus::failed && cell_.summary.failed++ == 0) {
    cell_.summary.why_failed = t.failure;
  }
  cell_.stated.add(t);
  if (t.measured && t.status == LocalisationStatus::unsure && cell_.summary.unsure++ == 0) {
    cell_.summary.why_unsure = t.failure;
  }
  if (!t.answered()) return;
  if (t.measured) {
    measured_.resize(t.measured->size());
    for (std::size_t i = 0; i < t.measured->size(); ++i) {
      const double value = (*t.measured)[i];
      if (std::isfinite(value)) measured_[i].push_back(value);
    }
  }
  const double turn = std::abs(t.heading_error_rad);
  ++answered_;
  successes_ += t.success();
  node_ += t.node_error_m <= success_radius_m;
  close_ += t.error <= 0.5 && turn <= 5 * degree;
  closer_ += t.error <= 0.25 && turn <= 2 * degree;
  errors_.push_back(t.error);
  turns_rad_.push_back(turn);
}

void CellTally::add(std::span<const TrialResult> block) {
  if (block.empty()) return;
  for (const TrialResult& trial : block) add(trial);
  cell_.outcomes.push_back(outcomes_of(block));
}

void CellTally::finish() {
  CellSummary& s = cell_.summary;
  const double n = std::max(1, s.trials);
  s.maps = static_cast<int>(cell_.maps.size());
  s.success = successes_ / n;
  s.success_interval_binomial_95 = wilson_interval(successes_, s.trials);
  s.success_interval_95 = clustered_interval_95(cell_.maps);
  if (cell_.interval_width && s.success_interval_95) {
    s.success_interval_95 = anytime_interval_95(cell_.maps);  // the one that it stops by
  }
  if (!s.success_interval_95) {
    s.why_no_interval = fmt::format("needs {} {}, has {}", fewest_maps,
                                    cell_.cell.system.is_localiser() ? "maps" : "blocks", s.maps);
  }
  s.coverage = answered_ / n;
  s.success_when_answered = answered_ > 0 ? static_cast<double>(successes_) / answered_
                                          : std::numeric_limits<double>::quiet_NaN();
  s.best_guess_success = guesses_ / n;
  s.node_success = node_ / n;
  s.recall_05 = close_ / n;
  s.recall_025 = closer_ / n;
  s.median_error = quantile_or_nan(errors_, 0.5);
  s.p95_error = quantile_or_nan(std::move(errors_), 0.95);
  for (std::vector<double>& values : measured_) s.measured.push_back(quantity_of(values));
  s.median_heading_error_rad = quantile_or_nan(std::move(turns_rad_), 0.5);
  s.cpu_ms_mean = cpu_ms_ / n;
  s.cpu_ms_median = quantile_or_nan(cpus_ms_, 0.5);
  s.cpu_ms_p95 = quantile_or_nan(std::move(cpus_ms_), 0.95);
  s.wall_ms_mean = wall_ms_ / n;
}

}  // namespace vernier::sim::internal
