// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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

/// What a threshold of the stated error rate gives: the queries answered and the errors among them.
struct ThresholdFigures {
  double max_error_rate = 1;
  double coverage = 0;  ///< fraction of trials answered at this threshold
  int answered = 0, wrong = 0;
  double stated_error = 0;  ///< mean of what these answers state; 0 without any
};

/// Whether more answers are wrong than a stated error rate allows, by more than chance: at least
/// twice as many at 98 % confidence.
bool understates_errors(int wrong, int answers, double stated_rate);

/// Stated against observed error rates of best guesses, sure or not. Trials are added one by one
/// and not kept.
class StatedErrors {
 public:
  void add(const TrialResult& trial);

  /// Mean of what was stated of the trials that were answered; 0 without any.
  double mean_of_answers() const { return answered_ > 0 ? stated_of_answers_ / answered_ : 0; }

  /// In ranges of about half a decade: a reliability diagram (Murphy and Winkler, Applied
  /// Statistics 26, 1977). Trials without a guess are left out, and so are ranges without answers.
  /// Empty for a method that states no probabilities.
  std::vector<ReliabilityBin> reliability() const;
  /// The same trials at other thresholds, 1 to 0.0001, as if what looks were taken did not depend
  /// on them. Empty for a method that states no probabilities.
  std::vector<ThresholdFigures> thresholds() const;

 private:
  struct Count {
    int answers = 0, wrong = 0;
    double stated_error = 0;  // sum
  };
  std::array<Count, 12> by_range_{};  // of the stated error rate
  std::array<Count, 25> up_to_{};     // at each threshold
  int trials_ = 0, answered_ = 0;
  double stated_of_answers_ = 0;  // sum
  bool states_probabilities_ = false;
};

}  // namespace vernier::sim::internal
