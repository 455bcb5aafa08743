// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/bootstrap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "calib/interval.h"
#include "calib/statistics/cluster_interval.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;

namespace {

ClusterStatistic mean_of(const std::vector<double>& values) {
  return [&values](std::span<const std::size_t> drawn) {
    double sum = 0;
    for (const std::size_t k : drawn) sum += values[k];
    return sum / static_cast<double>(drawn.size());
  };
}

TEST(Bootstrap, CoversTheMeanAsOftenAsItSays) {
  constexpr int trials = 400, clusters = 40;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    RandomStream draws({.seed = 71, .trial = static_cast<std::uint32_t>(t)});
    std::vector<double> values(clusters);
    for (double& v : values) v = -std::log(draws.uniform());  // mean 1
    const Interval i =
        bootstrap_interval(clusters, mean_of(values), {.resamples = 500, .seed = 72});
    covered += i.low <= 1 && 1 <= i.high;
  }
  // The percentile interval of 40 exponential deviates covers 92 to 93 %: 0.925 ± 4 sigma of 400
  // trials, wrong once in 16,000 runs.
  EXPECT_NEAR(covered / static_cast<double>(trials), 0.925, 4 * std::sqrt(0.925 * 0.075 / trials));
}

TEST(Bootstrap, HasTheVarianceOfAMean) {
  std::vector<double> values(30);
  std::iota(values.begin(), values.end(), 0.0);
  const Interval i = bootstrap_interval(values.size(), mean_of(values), {.resamples = 20'000});
  // A quantile of 20,000 resamples has a deviation of 0.019 sd, and means come in steps of 0.02 sd.
  const double sd = std::sqrt((30.0 * 30 - 1) / 12 / 30);
  EXPECT_NEAR(i.low, 14.5 - 1.96 * sd, 0.09 * sd);
  EXPECT_NEAR(i.high, 14.5 + 1.96 * sd, 0.09 * sd);
}

TEST(Bootstrap, WholeClustersAreDrawn) {
  bootstrap_interval(7,
                     [](std::span<const std::size_t> drawn) {
                       EXPECT_EQ(drawn.size(), 7u);
                       for (const std::size_t k : drawn) EXPECT_LT(k, 7u);
                       return 0.0;
                     },
                     {.resamples = 100});
}

TEST(Bootstrap, LeavesOutWhatIsNotFinite) {
  const auto value = [](std::span<const std::size_t> drawn) {
    return drawn[0] == 0 ? std::nan("") : static_cast<double>(drawn[0]);
  };
  const Interval i = bootstrap_interval(3, value);
  EXPECT_EQ(i.low, 1);
  EXPECT_EQ(i.high, 2);
  EXPECT_TRUE(std::isnan(bootstrap_interval(1, value).low));
  EXPECT_TRUE(std::isnan(
      bootstrap_interval(5, [](std::span<const std::size_t>) { return std::nan(""); }).high));
}

TEST(ClusterInterval, WidensByTheQuantilesOfItsConfidence) {
  constexpr int clusters = 5;
  std::vector<double> values(clusters);
  std::iota(values.begin(), values.end(), 0.0);
  for (const double confidence : {0.5, 0.9, 0.99}) {
    const BootstrapOptions options{.resamples = 999, .confidence = confidence};
    const Interval drawn = bootstrap_interval(clusters, mean_of(values), options);
    const Interval widened = cluster_interval(clusters, mean_of(values), options);
    const double upper = 0.5 + 0.5 * confidence;
    const double few = student_quantile(upper, clusters - 1) / normal_quantile(upper) *
                       std::sqrt(clusters / (clusters - 1.0));
    EXPECT_NEAR((2 - widened.low) / (2 - drawn.low), few, 1e-12) << confidence;
    EXPECT_NEAR((widened.high - 2) / (drawn.high - 2), few, 1e-12) << confidence;
  }
}

TEST(ClusterInterval, OfValuesTogetherIsThatOfEachAlone) {
  const std::vector<double> a{1, 4, 2, 8, 5}, b{0, 0, 3, 1, std::nan("")};
  int calls = 0;
  const ClusterStatistics both = [&](std::span<const std::size_t> drawn) {
    ++calls;
    return std::vector<double>{mean_of(a)(drawn), mean_of(b)(drawn)};
  };
  const BootstrapOptions options{.resamples = 99, .seed = 5};
  for (const int clusters : {0, 1, 2, 4, 5}) {
    calls = 0;
    const std::vector<Interval> together = cluster_intervals(clusters, 2, both, options);
    EXPECT_EQ(calls, clusters < 3 ? 0 : 100) << clusters;
    ASSERT_EQ(together.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      const Interval alone = cluster_interval(clusters, mean_of(i == 0 ? a : b), options);
      if (std::isnan(alone.low)) {
        EXPECT_TRUE(std::isnan(together[i].low) && std::isnan(together[i].high)) << clusters;
      } else {
        EXPECT_EQ(together[i].low, alone.low) << clusters;
        EXPECT_EQ(together[i].high, alone.high) << clusters;
      }
    }
  }
}

TEST(Bootstrap, RefusesOptionsOutOfBounds) {
  EXPECT_NE(test::error_message([] {
              bootstrap_interval(3, [](auto) { return 0.0; }, {.confidence = 1});
            }).find("between 0 and 1"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
