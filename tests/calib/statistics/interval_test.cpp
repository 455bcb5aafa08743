// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "calib/triangulation_uncertainty.h"
#include "calib/uncertainty/sampled_propagation.h"
#include "calib/validation/monte_carlo_check.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

// What is an interval is one Interval everywhere, unset from 0 to 0 where it is of no proportion.
TEST(Interval, IsTheTypeOfEveryInterval) {
  EXPECT_EQ(Interval{}, (Interval{0, 1}));
  EXPECT_NE(Interval{}, (Interval{0, 0.5}));
  EXPECT_EQ(DepthUncertainty().interval_95_m, (Interval{0, 0}));
  EXPECT_EQ(MonteCarloCheck().nees_interval_95, (Interval{0, 0}));
  EXPECT_EQ(MonteCarloCheck().nees_interval_99, (Interval{0, 0}));
  EXPECT_EQ(MonteCarloCheck().eigenvalue_band_99, (Interval{0, 0}));
  const std::vector<double> sorted{0, 1, 2, 3, 4};
  EXPECT_NEAR(interval_95(sorted).low, 0.1, 1e-12);
  EXPECT_NEAR(interval_95(sorted).high, 3.9, 1e-12);
}

// Known figures: 835 and 256 of 900.
TEST(Wilson, KnownIntervals) {
  const Interval high = wilson_interval(835, 900), low = wilson_interval(256, 900);
  EXPECT_NEAR(high.low, 0.9090, 5e-5);
  EXPECT_NEAR(high.high, 0.9429, 5e-5);
  EXPECT_NEAR(low.low, 0.2559, 5e-5);
  EXPECT_NEAR(low.high, 0.3148, 5e-5);
}

TEST(Wilson, StaysInsideZeroAndOne) {
  EXPECT_EQ(wilson_interval(0, 0).high, 1);
  EXPECT_NEAR(wilson_interval(0, 20).low, 0, 1e-15);
  EXPECT_NEAR(wilson_interval(20, 20).high, 1, 1e-15);
  EXPECT_GT(wilson_interval(20, 20).low, 0.8);
}

TEST(Wilson, RefusesWhatIsNoProportion) {
  const auto said = [](double successes, double trials, double confidence) {
    return test::error_message([=] { wilson_interval(successes, trials, confidence); });
  };
  EXPECT_NE(said(11, 10, 0.95).find("11 successes of 10"), std::string::npos);
  for (const double confidence : {0.0, 1.0, -0.5, 1.5, std::nan("")}) {
    EXPECT_NE(said(5, 10, confidence).find("between 0 and 1"), std::string::npos) << confidence;
  }
  EXPECT_NE(said(-1, 10, 0.95), "");
  EXPECT_NE(said(0, -1, 0.95), "");
  EXPECT_NE(said(std::nan(""), 10, 0.95), "");
  EXPECT_NE(said(1, std::nan(""), 0.95), "");
  EXPECT_EQ(said(2.5, 7.3, 0.95), "");  // an effective number
}

TEST(DesignEffect, OneForEvenClustersAndLargeForUnevenOnes) {
  const std::vector<ClusterCount> even(6, {45, 50});
  EXPECT_EQ(design_effect(even), 1);
  const std::vector<ClusterCount> uneven{{50, 50}, {50, 50}, {50, 50}, {20, 50}};
  EXPECT_GT(design_effect(uneven), 10);
  EXPECT_EQ(design_effect(std::vector<ClusterCount>{{3, 5}}), 1);
}

TEST(DesignEffect, RefusesCountsThatCannotBe) {
  const auto complaint = [](const ClusterCount& count) {
    return test::error_message([&] { design_effect(std::vector<ClusterCount>{{3, 5}, count}); });
  };
  EXPECT_EQ(complaint({-1, 2}),
            "design effect: -1 successes of 2 in a cluster; give 0 <= successes <= trials");
  EXPECT_NE(complaint({3, 2}), "");
}

}  // namespace
}  // namespace vernier
