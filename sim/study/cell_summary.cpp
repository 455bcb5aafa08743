// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/cell_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/quantile.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/budget.h"
#include "sim/study/study.h"
#include "sim/study/success_interval.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using namespace localise;

namespace {

/// NaN if there are none.
double quantile_or_nan(const std::vector<double>& values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return quantile(values, p, QuantileKind::linear);
}

}  // namespace

CellSummary summarise(const CellResult& cell) {
  constexpr double degree = 0.017453292519943295;
  CellSummary s;
  s.trials = static_cast<int>(cell.trials.size());
  s.maps = static_cast<int>(cell.maps.size());
  int successes = 0, answered = 0, guesses = 0, node = 0, close = 0, closer = 0;
  std::vector<double> errors, headings, cpu;
  double wall = 0;
  for (const TrialResult& t : cell.trials) {
    cpu.push_back(t.cpu_ms);
    wall += t.wall_ms;
    guesses += t.error_m <= success_radius_m;
    s.failed += t.status == LocalisationStatus::failed;
    if (!t.answered()) continue;
    ++answered;
    const double turn = std::abs(t.heading_error_rad);
    successes += t.success();
    node += t.node_error_m <= success_radius_m;
    close += t.error_m <= 0.5 && turn <= 5 * degree;
    closer += t.error_m <= 0.25 && turn <= 2 * degree;
    errors.push_back(t.error_m);
    headings.push_back(turn);
  }
  const double n = std::max(1, s.trials);
  s.success = successes / n;
  s.success_interval_binomial_95 = wilson_interval(successes, s.trials);
  s.success_interval_95 = clustered_interval_95(cell.maps);
  if (cell.interval_width && s.success_interval_95) {
    s.success_interval_95 = anytime_interval_95(cell.maps);  // the one that it stops by
  }
  if (!s.success_interval_95) {
    s.why_no_interval = fmt::format("needs {} maps, has {}", fewest_maps, s.maps);
  }
  s.coverage = answered / n;
  s.success_when_answered = answered > 0 ? static_cast<double>(successes) / answered : 0;
  s.best_guess_success = guesses / n;
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

}  // namespace vernier::sim::internal
