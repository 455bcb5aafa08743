// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/interval.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/error.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"

namespace vernier {

using namespace internal;

Interval wilson_interval(double successes, double trials, double confidence) {
  if (!(successes >= 0 && successes <= trials && confidence > 0 && confidence < 1)) {
    throw Error(
        "Wilson's interval",
        fmt::format("{} successes of {} at a confidence of {}", successes, trials, confidence),
        "give 0 <= successes <= trials and a confidence between 0 and 1");
  }
  if (trials == 0) return {0, 1};
  const double z = normal_quantile(0.5 + 0.5 * confidence), p = successes / trials;
  const double shrink = 1 + z * z / trials;
  const double centre = (p + z * z / (2 * trials)) / shrink;
  const double half = z * std::sqrt(p * (1 - p) / trials + z * z / (4 * trials * trials)) / shrink;
  // p lies within, also where rounding says otherwise
  return {std::clamp(centre - half, 0.0, p), std::clamp(centre + half, p, 1.0)};
}

Interval clopper_pearson_interval(int successes, int trials, double confidence) {
  if (successes < 0 || successes > trials || !(confidence > 0 && confidence < 1)) {
    throw Error(
        "Clopper-Pearson interval",
        fmt::format("{} successes of {} at a confidence of {}", successes, trials, confidence),
        "give 0 <= successes <= trials and a confidence between 0 and 1");
  }
  const double tail = 0.5 * (1 - confidence);
  Interval interval;
  if (successes > 0) interval.low = beta_quantile(tail, successes, trials - successes + 1);
  if (successes < trials) {
    interval.high = beta_quantile(1 - tail, successes + 1, trials - successes);
  }
  return interval;
}

double design_effect(std::span<const ClusterCount> clusters) {
  double trials = 0, successes = 0;
  for (const ClusterCount& c : clusters) {
    if (c.successes < 0 || c.successes > c.trials) {
      throw Error("design effect",
                  fmt::format("{} successes of {} in a cluster", c.successes, c.trials),
                  "give 0 <= successes <= trials");
    }
    trials += c.trials;
    successes += c.successes;
  }
  const auto k = static_cast<double>(clusters.size());
  if (k < 2 || !(trials > 0)) return 1;
  const double p = successes / trials;
  const double binomial = p * (1 - p) / trials;
  if (!(binomial > 0)) return 1;
  double between = 0;
  for (const ClusterCount& c : clusters) {
    const double residual = c.successes - p * c.trials;
    between += residual * residual;
  }
  between *= k / (k - 1) / (trials * trials);
  return std::max(1.0, between / binomial);
}

}  // namespace vernier
