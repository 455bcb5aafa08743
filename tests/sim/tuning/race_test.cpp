// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/race.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "calib/error.h"
#include "sim/tuning/paired_scores.h"
#include "tests/support/made_settings.h"

namespace vernier {

using namespace vernier::sim::internal;

namespace {

constexpr double point = 0.01 + 1e-9;

TEST(RaceStages, HalveTheCandidatesUpToAllRounds) {
  for (const int candidates : {2, 3, 7, 30, 1000}) {
    for (const int rounds : {1, 2, 6, 18, 40, 1000}) {
      const std::vector<RaceStage> stages = race_stages(candidates, rounds);
      EXPECT_EQ(stages.front().candidates, candidates);
      EXPECT_EQ(stages.back().rounds, rounds);
      for (std::size_t s = 1; s < stages.size(); ++s) {
        EXPECT_GT(stages[s].rounds, stages[s - 1].rounds);
        EXPECT_LE(stages[s].candidates, (stages[s - 1].candidates + 1) / 2);
      }
      EXPECT_LE(cost_of(stages), static_cast<std::int64_t>(candidates) * rounds);
    }
  }
  // 30 candidates cost 4.9 + 1 times the rounds of one, as the header says, in place of 30.
  EXPECT_NEAR(static_cast<double>(cost_of(race_stages(30, 1600))), 1600 * (1 + std::log2(30)), 300);
}

// The bar: within 1 point of the best in 95 of 100 runs with a third of the trials of a full grid.
// 97 % of such races hit (bench/tune_race.cpp, 400 runs), so that fewer than 36 of 40 do has a
// probability of 0.6 %, by Binomial(40, 0.97); the seed is fixed.
TEST(Race, FindsASettingWithinAPointOfTheBestForAThirdOfTheTrials) {
  const test::MadeSettings made{.success = test::steps_from(0.80, 0.005, 30), .seed = 5};
  constexpr int candidates = 30, rounds = 40, runs = 40;
  int hits = 0;
  for (std::uint32_t run = 0; run < runs; ++run) {
    const test::MadeRace race(made, run);
    const test::MadeResult result = test::run_race(race, candidates, rounds, {});
    const double lost = race.best() - race.success(result.winner);
    hits += lost <= point;
    EXPECT_LE(3 * result.rounds, candidates * rounds);
  }
  EXPECT_GE(hits, 36);
}

// How much better another may be: of 40 races 38 are right with an exact limit of 95 %, and fewer
// than 34 have a probability of 1.4 %. Wider limits would always be right: these say something.
TEST(Race, TheLimitToABetterCandidateHolds) {
  for (const double map_effect : {0.0, 0.05}) {
    test::MadeSettings made{.success = test::steps_from(0.70, 0.01, 20), .seed = 10};
    made.own_effect = made.common_effect = map_effect;
    int held = 0;
    for (std::uint32_t run = 0; run < 40; ++run) {
      const test::MadeRace race(made, run);
      const test::MadeResult result = test::run_race(race, 20, 40, {});
      const double limit = shortfall_limit(result.scores, result.winner, 0.05);
      held += race.best() - race.success(result.winner) <= limit;
      EXPECT_LT(limit, 0.3);
    }
    EXPECT_GE(held, 34) << map_effect;
  }
}

// With two candidates nothing but the test can drop one early. Both differ by just the
// indifference, the case in which the test errs most often: of 300 races the 5 % that it may err in
// are 15, and more than 27 have a probability of 0.2 %.
TEST(Race, TheTestDropsTheBetterOneNoMoreOftenThanItsErrorRate) {
  for (const double map_effect : {0.0, 0.1}) {
    test::MadeSettings made{.success = {0.90, 0.89}, .trials_a_round = 20, .seed = 6};
    made.own_effect = map_effect;
    if (map_effect > 0) made.success = {0.60, 0.59};
    int wrong = 0;
    for (std::uint32_t run = 0; run < 300; ++run) {
      const test::MadeRace race(made, run);
      const test::MadeResult result = test::run_race(race, 2, 60, {});
      for (int i = 0; i < 2; ++i) {
        wrong += race.success(i) == race.best() && result.state.racers[i].fate == Fate::worse;
      }
    }
    RecordProperty(map_effect > 0 ? "wrong_of_300_maps_differ" : "wrong_of_300", wrong);
    EXPECT_LE(wrong, 27) << map_effect;
  }
}

TEST(Race, ResultsDoNotDependOnTheOrderInWhichRoundsCome) {
  const test::MadeSettings made{.success = test::steps_from(0.5, 0.04, 9), .seed = 7};
  const test::MadeRace race(made, 0);
  const test::MadeResult stepwise = test::run_race(race, 9, 24, {});
  RaceScores all(9);
  for (int i = 0; i < 9; ++i) {
    for (int k = 0; k < 24; ++k) all[i].push_back(race.round(i, k));
  }
  const RaceState at_once = follow_race(all, 24, {});
  ASSERT_TRUE(at_once.over);
  EXPECT_EQ(at_once.leader, stepwise.winner);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(at_once.racers[i].fate, stepwise.state.racers[i].fate);
    EXPECT_EQ(at_once.racers[i].rounds, stepwise.state.racers[i].rounds);
  }
}

TEST(Race, NeverAsksForLessThanBefore) {
  const test::MadeSettings made{.success = test::steps_from(0.5, 0.04, 9), .seed = 8};
  const test::MadeRace race(made, 0);
  RaceScores scores(9);
  std::vector<int> asked(9, 0);
  for (;;) {
    const RaceState state = follow_race(scores, 24, {});
    for (int i = 0; i < 9; ++i) {
      EXPECT_GE(state.racers[i].rounds, asked[i]);
      asked[i] = state.racers[i].rounds;
    }
    if (state.over) break;
    // One round of one candidate at a time, the last first.
    for (int i = 8; i >= 0; --i) {
      if (static_cast<int>(scores[i].size()) < asked[i]) {
        scores[i].push_back(race.round(i, static_cast<int>(scores[i].size())));
        break;
      }
    }
  }
}

TEST(Race, OfEqualsTheFirstWins) {
  const RaceScores scores(5, std::vector<std::vector<double>>(8, {1, 0, 1}));
  const RaceState state = follow_race(scores, 8, {});
  EXPECT_TRUE(state.over);
  EXPECT_EQ(state.leader, 0);
  EXPECT_EQ(ranking(state, scores)[0], 0);
}

TEST(Race, EndsEarlyWhereOneIsClearlyBetter) {
  RaceScores scores(2, std::vector<std::vector<double>>(40, std::vector<double>(20, 0)));
  for (auto& round : scores[1]) std::fill(round.begin(), round.end(), 1);
  const RaceState state = follow_race(scores, 40, {});
  EXPECT_EQ(state.leader, 1);
  EXPECT_EQ(state.racers[0].fate, Fate::worse);
  EXPECT_LT(state.racers[0].rounds, 20);
}

TEST(Race, RefusesWhatIsNoRace) {
  EXPECT_THROW(follow_race({}, 6, {}), Error);
  EXPECT_THROW(follow_race(RaceScores(2), 0, {}), Error);
  EXPECT_THROW(follow_race(RaceScores(2), 6, {.indifference = -0.1}), Error);
  EXPECT_THROW(follow_race(RaceScores(2), 6, {.error_rate = 0.5}), Error);
}

// At any of 60 rounds, so the rate of sequences in which it ever fails: of 400, the 5 % that it may
// fail in are 20, and more than 34 have a probability of 0.1 %.
TEST(PairedScores, TheLimitHoldsAtAnyTime) {
  int most = 0;
  struct Case {
    double a, b, effect;
    int trials;
  };
  for (const Case& c : {Case{0.9, 0.9, 0, 20}, Case{0.99, 0.98, 0, 20}, Case{0.5, 0.7, 0, 5},
                        Case{0.6, 0.6, 0.1, 50}, Case{1.0, 0.999, 0, 50}}) {
    test::MadeSettings made{.success = {c.a, c.b}, .trials_a_round = c.trials, .seed = 9};
    made.own_effect = c.effect;
    int failures = 0;
    for (std::uint32_t run = 0; run < 400; ++run) {
      const test::MadeRace race(made, run);
      PairedScores pair;
      bool failed = false;
      for (int k = 0; k < 60; ++k) {
        pair.add_round(race.round(0, k), race.round(1, k));
        failed = failed || pair.upper_limit(0.05) < race.success(0) - race.success(1);
      }
      failures += failed;
    }
    most = std::max(most, failures);
    EXPECT_LE(failures, 34) << c.a << " " << c.b;
  }
  RecordProperty("most_failures_of_400", most);
}

TEST(PairedScores, RefusesOtherTrials) {
  PairedScores pair;
  EXPECT_THROW(pair.add_round(std::vector<double>{1, 0}, std::vector<double>{1}), Error);
  EXPECT_THROW(static_cast<void>(pair.upper_limit(0)), Error);
  EXPECT_EQ(pair.upper_limit(0.05), 1);
}

}  // namespace
}  // namespace vernier
