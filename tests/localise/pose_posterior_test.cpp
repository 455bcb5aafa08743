// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/posterior/pose_posterior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace vernier::localise::internal {
namespace {

TEST(PosePosterior, SharesOutProbability) {
  const PosteriorOptions options;
  const std::vector<Hypothesis> two{
      {{0, 0, 0}, 0, -50}, {{0.1, 0, 0}, 0, -60}, {{8, 0, 0}, 1, -50}};
  const auto modes = pose_posterior(two, {300, 100}, 200, options);
  ASSERT_EQ(modes.size(), 2u);  // the second is the first's
  EXPECT_NEAR(modes[0].probability, 0.5, 200 * options.unknown);
  EXPECT_NEAR(modes[1].probability, 0.5, 200 * options.unknown);
  // A score that is bad for a view of so many lines leaves the truth elsewhere.
  const std::vector<Hypothesis> bad{{{0, 0, 0}, 0, -1500}};
  EXPECT_LT(pose_posterior(bad, {300, 100}, 200, options)[0].probability, 1e-6);
  EXPECT_TRUE(pose_posterior({}, {300, 100}, 200, options).empty());
  // The worse the views fit, the less a difference of scores counts.
  double before = 1;
  for (const double score : {-30.0, -200.0, -400.0}) {
    const std::vector<Hypothesis> rivals{{{0, 0, 0}, 0, score}, {{8, 0, 0}, 1, score - 4}};
    const double now = pose_posterior(rivals, {300, 100}, 200, options)[0].probability;
    EXPECT_LT(now, before - 0.01) << score;
    before = now;
  }
  // In a larger map more places are like another.
  const std::vector<Hypothesis> alone{{{0, 0, 0}, 0, -5}};
  EXPECT_GT(pose_posterior(alone, {40, 100}, 200)[0].probability,
            pose_posterior(alone, {40, 100}, 20000)[0].probability + 0.01);
  // A robot that may be off the map is less sure, the more so the worse the view fits.
  PosteriorOptions may_leave;
  may_leave.off_map = 0.1;
  const double on_map = pose_posterior(alone, {40, 100}, 200, may_leave)[0].probability;
  EXPECT_LT(on_map, pose_posterior(alone, {40, 100}, 200)[0].probability - 0.001);
  const std::vector<Hypothesis> doubtful{{{0, 0, 0}, 0, -50}};
  EXPECT_LT(pose_posterior(doubtful, {40, 100}, 200, may_leave)[0].probability, on_map - 0.1);
  // Two poses close to each other are more probable together than one that scores better alone.
  const std::vector<Hypothesis> pair{{{0, 0, 0}, 0, 0}, {{8, 0, 0}, 1, -1}, {{8.5, 0, 0}, 1, -1}};
  EXPECT_EQ(pose_posterior(pair, {300, 100}, 200, options)[0].best.node, 1);
}

// What a view of a bare corridor does not show is no proof.
TEST(PosePosterior, FewLinesAreHalfBelieved) {
  const std::vector<Hypothesis> alone{{{0, 0, 0}, 0, -1}};
  const auto error = [&](std::size_t lines) {
    return 1 - pose_posterior(alone, {12, lines}, 60)[0].probability;
  };
  EXPECT_GT(error(1), 0.9);
  EXPECT_NEAR(error(4), 0.5, 0.01);
  EXPECT_NEAR(error(6), 0.06, 0.01);
  EXPECT_LT(error(10), 0.002);
}

// Odds of a rival are those of the scores' difference, as often as it counts.
TEST(PosePosterior, ADifferenceOfScoresIsTempered) {
  PosteriorOptions options;
  options.thin = options.unknown = 0;
  for (const double nats : {0.5, 3.0, 9.0}) {
    const std::vector<Hypothesis> two{{{0, 0, 0}, 0, -5}, {{8, 0, 0}, 1, -5 - nats}};
    const auto modes = pose_posterior(two, {300, 100}, 200, options);
    EXPECT_NEAR(std::log(modes[0].probability / modes[1].probability),
                options.tempering * options.evidence_share * nats, 1e-9);
  }
}

// 0.1 times an overflow must not become NaN, and certainty has a floor.
TEST(PosePosterior, StaysFinite) {
  for (const double off_map : {0.0, 0.1}) {
    PosteriorOptions options;
    options.off_map = off_map;
    for (const double score : {-1e9, -1e300, 0.0}) {
      const std::vector<Hypothesis> one{{{0, 0, 0}, 0, score}};
      for (const double observations : {0.0, 3.0, 1e6}) {
        const double p = pose_posterior(one, {observations, 100}, 200, options)[0].probability;
        EXPECT_TRUE(p >= 0 && p <= 1) << score << ' ' << observations;
        EXPECT_LE(p, 1 - least_error_rate(200, options) + 1e-12);
      }
    }
  }
}

// A misfit weighs more in a larger map, up to 160 times the usual one's nodes.
TEST(PosePosterior, AMisfitWeighsMoreInALargerMap) {
  PosteriorOptions options;
  options.thin = 0;
  options.unknown = 0;
  const std::vector<Hypothesis> bad{{{0, 0, 0}, 0, -450}};
  const auto odds_against = [&](std::size_t nodes) {
    const double p = pose_posterior(bad, {225, 100}, nodes, options)[0].probability;
    return (1 - p) / p;
  };
  EXPECT_NEAR(odds_against(1800) / odds_against(180), 100, 1e-3);
  EXPECT_NEAR(odds_against(100'000) / odds_against(180), 160 * 160, 1);
}

}  // namespace
}  // namespace vernier::localise::internal
