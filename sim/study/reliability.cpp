// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/reliability.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "calib/interval.h"
#include "sim/experiment.h"

namespace vernier::sim::internal {

namespace {

/// Borders of the ranges, from sure to unsure.
constexpr double borders[] = {0, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1};

bool has_guess(const TrialResult& trial) { return std::isfinite(trial.error_m); }

bool states_probabilities(std::span<const TrialResult> trials) {
  return std::any_of(trials.begin(), trials.end(),
                     [](const TrialResult& t) { return has_guess(t) && t.probability > 0; });
}

double stated_error(const TrialResult& trial) {
  return std::clamp(1 - trial.probability, 0.0, 1.0);
}

}  // namespace

std::vector<ReliabilityBin> reliability(std::span<const TrialResult> trials) {
  if (!states_probabilities(trials)) return {};
  std::vector<ReliabilityBin> all;
  for (std::size_t i = 0; i + 1 < std::size(borders); ++i) {
    ReliabilityBin bin;
    bin.low = borders[i];
    bin.high = borders[i + 1];
    for (const TrialResult& t : trials) {
      const double stated = stated_error(t);
      const bool is_last = i + 2 == std::size(borders);
      if (!has_guess(t) || stated < bin.low || !(stated < bin.high || is_last)) continue;
      ++bin.answers;
      bin.wrong += t.error_m > success_radius_m;
      bin.stated_error += stated;
    }
    if (bin.answers == 0) continue;
    bin.stated_error /= bin.answers;
    bin.error_interval_95 = clopper_pearson_interval(bin.wrong, bin.answers);
    all.push_back(bin);
  }
  return all;
}

std::vector<ThresholdFigures> thresholds(std::span<const TrialResult> trials) {
  if (!states_probabilities(trials)) return {};
  std::vector<ThresholdFigures> all;
  for (const double most :
       {1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4}) {
    ThresholdFigures at{most, 0, 0, 0};
    for (const TrialResult& t : trials) {
      if (!has_guess(t) || stated_error(t) > most) continue;
      ++at.answered;
      at.wrong += t.error_m > success_radius_m;
    }
    at.coverage = static_cast<double>(at.answered) / static_cast<double>(trials.size());
    all.push_back(at);
  }
  return all;
}

}  // namespace vernier::sim::internal
