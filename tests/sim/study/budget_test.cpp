// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calib/error.h"
#include "calib/interval.h"
#include "calib/statistics/confidence_sequence.h"
#include "tests/support/made_maps.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim::internal;

namespace {

// The capital of section 4.2 by the definition, at a mean on either side of the ends found.
TEST(ConfidenceSequence, EndsWhereTheCapitalReachesOneOverAlpha) {
  const std::vector<double> x{0.9, 1, 0.8, 0.95, 0.7, 1, 0.9, 0.85, 1, 0.6, 0.9, 0.9};
  const auto capital = [&](double m, bool above) {
    double product = 0.5, sum = 0, squares = 0.03, variance = 0.03;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double t = static_cast<double>(i) + 1;
      const double bet = std::sqrt(2 * std::log(2 / 0.05) / (variance * t * std::log(t + 1)));
      product *= above ? 1 + std::min(bet, 0.9 / m) * (x[i] - m)
                       : 1 - std::min(bet, 0.9 / (1 - m)) * (x[i] - m);
      sum += x[i];
      squares += std::pow(x[i] - sum / t, 2);
      variance = squares / (t + 1);
    }
    return product;
  };
  const Interval i = confidence_sequence(x);
  EXPECT_GT(capital(i.low - 1e-6, true), 20);
  EXPECT_LT(capital(i.low + 1e-6, true), 20);
  EXPECT_LT(i.low, 0.875);
  EXPECT_GT(i.high, 0.875);
  if (i.high < 1) {
    EXPECT_GT(capital(i.high + 1e-6, false), 20);
    EXPECT_LT(capital(i.high - 1e-6, false), 20);
  }
}

TEST(ConfidenceSequence, IsSymmetricAndRefusesWhatIsNoShare) {
  const std::vector<double> x{0.1, 0.5, 0.2, 0.3, 0.15, 0.2, 0.25};
  std::vector<double> mirrored;
  for (const double v : x) mirrored.push_back(1 - v);
  const Interval a = confidence_sequence(x), b = confidence_sequence(mirrored);
  EXPECT_NEAR(a.low, 1 - b.high, 1e-12);
  EXPECT_NEAR(a.high, 1 - b.low, 1e-12);
  EXPECT_EQ(confidence_sequence({}), Interval());
  EXPECT_THROW(confidence_sequence(std::vector<double>{1.5}), Error);
  EXPECT_THROW(confidence_sequence(x, 1), Error);
}

// Seed 31. The interval may leave the truth out at any of 120 looks in at most 5 % of the studies;
// 400 studies have a standard deviation of 1.1 points, and the bound is four of them away: a false
// alarm in any row has a probability below 4e-4.
TEST(ConfidenceSequence, HoldsTheTruthAtAllLooksTogether) {
  for (const double success : {0.5, 0.9, 0.99}) {
    const MapMaker maker({MapKind::beta, success, 0.05, 50, 31});
    int out = 0;
    constexpr std::uint32_t studies = 400;
    for (std::uint32_t study = 0; study < studies; ++study) {
      const std::vector<ClusterCount> maps = maker.maps(study, 120);
      bool ever = false;
      for (std::size_t looked = 1; looked <= maps.size() && !ever; ++looked) {
        const Interval i = anytime_interval_95(std::span(maps).first(looked));
        ever = success < i.low || i.high < success;
      }
      out += ever;
    }
    EXPECT_LE(out, 0.095 * studies) << success;
  }
}

std::vector<ClusterCount> same_maps(int count, int successes) {
  return std::vector<ClusterCount>(static_cast<std::size_t>(count), {successes, 50});
}

TEST(Budget, WithoutAWidthAllBlocksAreWanted) {
  EXPECT_EQ(budget_decision({}, 18, std::nullopt).wanted, 18);
  EXPECT_EQ(budget_decision(same_maps(17, 50), 18, std::nullopt).state, BudgetState::going_on);
  EXPECT_EQ(budget_decision(same_maps(18, 50), 18, std::nullopt).state, BudgetState::spent);
}

TEST(Budget, LooksAtFixedNumbersOfBlocksInOrder) {
  const std::vector<ClusterCount> maps = same_maps(400, 48);
  const BudgetDecision all = budget_decision(maps, 400, 0.05);
  ASSERT_EQ(all.state, BudgetState::narrow);
  ASSERT_GT(all.wanted, 6);
  ASSERT_LT(all.wanted, 400);
  // What is there beyond the stop, or not yet there, changes nothing.
  int wanted_before = 0;
  for (int there = 0; there <= 400; ++there) {
    const std::span<const ClusterCount> first = std::span(maps).first(there);
    const BudgetDecision d = budget_decision(first, 400, 0.05);
    if (there >= all.wanted) {
      EXPECT_EQ(d.state, BudgetState::narrow);
      EXPECT_EQ(d.wanted, all.wanted);
    } else {
      EXPECT_EQ(d.state, BudgetState::going_on);
      EXPECT_GT(d.wanted, there);
      EXPECT_LE(d.wanted, all.wanted);
      EXPECT_GE(d.wanted, wanted_before);
      wanted_before = d.wanted;
    }
  }
  const Interval i = anytime_interval_95(std::span(maps).first(all.wanted));
  EXPECT_LE(i.high - i.low, 0.05);
}

TEST(Budget, EndsWithTheTrials) {
  const BudgetDecision d = budget_decision(same_maps(7, 25), 7, 0.01);
  EXPECT_EQ(d.state, BudgetState::spent);
  EXPECT_EQ(d.wanted, 7);
  EXPECT_EQ(budget_decision(same_maps(2, 25), 2, 0.01).state, BudgetState::spent);
}

}  // namespace
}  // namespace vernier
