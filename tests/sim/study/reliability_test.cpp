// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/reliability.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "localise/localiser.h"
#include "sim/experiment.h"

namespace vernier {

using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

TrialResult guess(double probability, double error_m) {
  TrialResult trial;
  trial.status = LocalisationStatus::unsure;
  trial.probability = probability;
  trial.error = error_m;
  return trial;
}

TrialResult no_guess() {
  TrialResult trial;
  trial.status = LocalisationStatus::no_match;
  trial.error = std::numeric_limits<double>::quiet_NaN();
  return trial;
}

StatedErrors all(const std::vector<TrialResult>& trials) {
  StatedErrors stated;
  for (const TrialResult& trial : trials) stated.add(trial);
  return stated;
}

TEST(Reliability, CountsErrorsByWhatWasStated) {
  std::vector<TrialResult> trials(90, guess(0.97, 0.1));
  trials.insert(trials.end(), 10, guess(0.96, 5));
  trials.insert(trials.end(), 3, guess(0, 7));  // the last range includes its upper border
  trials.insert(trials.end(), 7, no_guess());
  const std::vector<ReliabilityBin> bins = all(trials).reliability();
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_EQ(bins[0].answers, 100);
  EXPECT_EQ(bins[0].wrong, 10);
  EXPECT_NEAR(bins[0].stated_error, (90 * 0.03 + 10 * 0.04) / 100, 1e-12);
  EXPECT_NEAR(bins[0].error_interval_95.low, 0.0490, 1e-4);  // Clopper-Pearson, 10 of 100
  EXPECT_NEAR(bins[0].error_interval_95.high, 0.1762, 1e-4);
  EXPECT_EQ(bins[1].answers, 3);
  EXPECT_EQ(bins[1].wrong, 3);
}

TEST(Reliability, AThresholdTradesCoverageForErrors) {
  std::vector<TrialResult> trials(80, guess(0.9999, 0.1));
  trials.insert(trials.end(), 10, guess(0.9, 5));
  trials.insert(trials.end(), 10, no_guess());
  for (const ThresholdFigures& at : all(trials).thresholds()) {
    const bool both = at.max_error_rate >= 0.1;
    EXPECT_EQ(at.answered, both ? 90 : 80) << at.max_error_rate;
    EXPECT_EQ(at.wrong, both ? 10 : 0) << at.max_error_rate;
    EXPECT_DOUBLE_EQ(at.coverage, both ? 0.9 : 0.8) << at.max_error_rate;
    EXPECT_NEAR(at.stated_error, both ? (80 * 0.0001 + 10 * 0.1) / 90 : 0.0001, 1e-12);
  }
}

TEST(Reliability, IsEmptyWithoutProbabilities) {
  const std::vector<TrialResult> trials(5, guess(0, 0.1));
  EXPECT_TRUE(all(trials).reliability().empty());
  EXPECT_TRUE(all(trials).thresholds().empty());
  EXPECT_TRUE(all({}).reliability().empty());
}

}  // namespace
}  // namespace vernier
