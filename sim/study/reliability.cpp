// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/reliability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calib/interval.h"
#include "sim/experiment.h"

namespace vernier::sim::internal {

namespace {

/// Borders of the ranges, from sure to unsure.
constexpr std::array<double, 13> borders{0,    2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01,
                                         0.02, 0.05, 0.1,  0.2,  0.5,  1};

/// From unsure to sure.
constexpr std::array<double, 25> limits{1,    0.7,  0.5,   0.3,  0.2,  0.15,   0.1,  0.07, 0.05,
                                        0.03, 0.02, 0.015, 0.01, 7e-3, 5e-3,   3e-3, 2e-3, 1.5e-3,
                                        1e-3, 7e-4, 5e-4,  3e-4, 2e-4, 1.5e-4, 1e-4};

}  // namespace

bool understates_errors(int wrong, int answers, double stated_rate) {
  constexpr double sure = 0.98;
  return answers > 0 && clopper_pearson_interval(wrong, answers, sure).low > 2 * stated_rate;
}

void StatedErrors::add(const TrialResult& trial) {
  ++trials_;
  if (!std::isfinite(trial.error)) return;  // no guess
  states_probabilities_ |= trial.probability > 0;
  const double stated = std::clamp(1 - trial.probability, 0.0, 1.0);
  if (trial.answered()) {
    ++answered_;
    stated_of_answers_ += stated;
  }
  const bool wrong = trial.error > success_radius_m;  // of which the probability is stated
  const auto above = std::upper_bound(borders.begin(), borders.end() - 1, stated);
  Count& range = by_range_[static_cast<std::size_t>(above - borders.begin()) - 1];
  ++range.answers;
  range.wrong += wrong;
  range.stated_error += stated;
  for (std::size_t i = 0; i < limits.size() && stated <= limits[i]; ++i) {
    ++up_to_[i].answers;
    up_to_[i].stated_error += stated;
    up_to_[i].wrong += wrong;
  }
}

std::vector<ReliabilityBin> StatedErrors::reliability() const {
  if (!states_probabilities_) return {};
  std::vector<ReliabilityBin> all;
  for (std::size_t i = 0; i < by_range_.size(); ++i) {
    const Count& range = by_range_[i];
    if (range.answers == 0) continue;
    all.push_back({.low = borders[i],
                   .high = borders[i + 1],
                   .answers = range.answers,
                   .wrong = range.wrong,
                   .stated_error = range.stated_error / range.answers,
                   .error_interval_95 = clopper_pearson_interval(range.wrong, range.answers)});
  }
  return all;
}

std::vector<ThresholdFigures> StatedErrors::thresholds() const {
  if (!states_probabilities_) return {};
  std::vector<ThresholdFigures> all;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const Count& at = up_to_[i];
    all.push_back({.max_error_rate = limits[i],
                   .coverage = static_cast<double>(at.answers) / trials_,
                   .answered = at.answers,
                   .wrong = at.wrong,
                   .stated_error = at.answers > 0 ? at.stated_error / at.answers : 0});
  }
  return all;
}

}  // namespace vernier::sim::internal
