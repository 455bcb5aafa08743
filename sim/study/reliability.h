// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "calib/interval.h"
#include "sim/experiment.h"

namespace vernier::sim::internal {

/// Answers whose stated probabilities of an error lie in one range.
struct ReliabilityBin {
  double low = 0, high = 1;  ///< of the stated error rate
  int answers = 0, wrong = 0;
  double stated_error = 0;  ///< mean
  /// Of the observed error rate; Clopper-Pearson, trials taken as independent.
  Interval error_interval_95;
};

/// Stated against observed error rates of best guesses, sure or not, in ranges of about half a
/// decade: a reliability diagram (Murphy and Winkler, Applied Statistics 26, 1977). Trials without
/// a guess are left out, and so are ranges without answers. Empty for a method that states no
/// probabilities.
std::vector<ReliabilityBin> reliability(std::span<const TrialResult> trials);

/// What a threshold of the stated error rate gives: the queries answered and the errors among them.
struct ThresholdFigures {
  double max_error_rate = 1;
  double coverage = 0;  ///< fraction of trials answered at this threshold
  int answered = 0, wrong = 0;
};

/// The same trials at other thresholds, 1 to 0.0001: of one look only, as further looks are taken
/// depending on the threshold. Empty for a method that states no probabilities.
std::vector<ThresholdFigures> thresholds(std::span<const TrialResult> trials);

}  // namespace vernier::sim::internal
