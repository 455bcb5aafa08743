// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/success_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "calib/rig_estimate.h"
#include "sim/experiment.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

const std::vector<SuccessAt> falling{{0, 1.0, {0.96, 1.0}},
                                     {1, 0.9, {0.84, 0.96}},
                                     {2, 0.92, {0.86, 0.98}},  // a rise by chance
                                     {4, 0.5, {0.4, 0.6}}};

TEST(SuccessCurve, TheScaleIsInterpolatedOfAFallingRate) {
  const ScaleNeeded needed = scale_needed(falling, 0.955);
  EXPECT_NEAR(needed.psi_c, 0.5, 1e-9);  // between 1 and the pooled 0.91
  EXPECT_LT(needed.low, needed.psi_c);
  EXPECT_GT(needed.high, needed.psi_c);
  EXPECT_FALSE(needed.beyond);
  // The upper limit at 2 cannot exceed that at 1; the lower one at 1 is at least that at 2.
  EXPECT_NEAR(scale_needed(falling, 0.96).high, 2, 1e-9);
  EXPECT_NEAR(scale_needed(falling, 0.86).low, 2, 1e-9);
}

TEST(SuccessCurve, WhatIsNeverMetOrAlwaysMetIsSaid) {
  const ScaleNeeded always = scale_needed(falling, 0.3);
  EXPECT_TRUE(always.beyond);
  EXPECT_EQ(always.psi_c, 4);
  std::vector<SuccessAt> poor = falling;
  poor[0] = {0, 0.9, {0.8, 0.94}};
  const ScaleNeeded never = scale_needed(poor, 0.97);
  EXPECT_EQ(never.psi_c, 0);
  EXPECT_EQ(never.low, 0);
}

TEST(SuccessCurve, IsTheSameForAnyNumberOfThreadsAndFallsWithTheError) {
  ExperimentSettings settings;
  settings.map_spacing_m = 1;
  SuccessCurveOptions options{.psi_c = {0, 1, 60}, .trials = 18, .threads = 1};
  const auto& rig = test::nominal_rig();
  const auto one =
      success_curve(test::small_office_visibility(), rig.rig, *rig.covariance, settings, options);
  options.threads = 2;
  const auto two =
      success_curve(test::small_office_visibility(), rig.rig, *rig.covariance, settings, options);
  ASSERT_EQ(one.size(), 3u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].success, two[i].success);
    EXPECT_EQ(one[i].interval_95, two[i].interval_95);
  }
  EXPECT_GT(one[0].success, one[2].success);
}

// Nearly all edges are lost, and little else goes wrong: without that loss all is well.
TEST(SuccessCurve, TheCauseThatLimitsMostComesFirst) {
  ExperimentSettings settings;
  settings.map_spacing_m = 1;
  settings.sources.edge_loss = 0.93;
  const auto& rig = test::nominal_rig();
  const SuccessCurveOptions options{.psi_c = {0}, .trials = 24, .threads = 2};
  const std::vector<LimitingCause> causes =
      limiting_causes(test::small_office_visibility(), rig.rig, *rig.covariance, settings, options);
  ASSERT_GT(causes.size(), 2u);
  EXPECT_EQ(causes[0].name, "edge_loss");
  const double now =
      success_curve(test::small_office_visibility(), rig.rig, *rig.covariance, settings, options)[0]
          .success;
  EXPECT_GT(causes[0].success, now + 0.3);
  EXPECT_LT(causes[1].success, now + 0.3);
  EXPECT_TRUE(std::none_of(causes.begin(), causes.end(),
                           [](const LimitingCause& c) { return c.name == "calibration"; }));
  // What is switched off already limits nothing.
  settings.sources.edge_loss = 0;
  for (const LimitingCause& cause : limiting_causes(test::small_office_visibility(), rig.rig,
                                                    *rig.covariance, settings, options)) {
    EXPECT_NE(cause.name, "edge_loss");
  }
}

}  // namespace
}  // namespace vernier
