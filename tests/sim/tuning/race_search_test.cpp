// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/tuning/race_search.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "calib/error.h"
#include "sim/experiment.h"
#include "sim/study/study.h"
#include "sim/tuning/confirmation.h"
#include "sim/tuning/objective.h"
#include "sim/tuning/race.h"
#include "sim/tuning/tune_settings.h"
#include "tests/support/example_study.h"

namespace vernier {

using namespace vernier::sim::internal;

namespace {

class RaceSearches : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("vernier_tune_" + std::to_string(::getpid()));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  struct Ended {
    RaceState state;
    RaceScores scores;
    int blocks = 0;  ///< that this run computed
  };

  /// Races in a folder; `stop_after` blocks, if not negative, it is asked to stop.
  Ended race(const std::string& name, int threads, int stop_after = -1) {
    RaceSearch search(study_, candidates_, settings_);
    Ended ended;
    std::stop_source stop;
    StudyRun job{.folder = folder_ / name, .threads = threads, .command = {}, .progress = {}};
    job.first_blocks = [&](const StudyWork& work, const StoredResults& stored) {
      return search.first_blocks(work, stored);
    };
    job.progress = [&](int done, int) {
      ended.blocks = done;
      if (stop_after >= 0 && done >= stop_after) stop.request_stop();
    };
    job.stop = stop.get_token();
    run_study(study_, job);
    ended.state = search.state();
    ended.scores = search.scores();
    return ended;
  }

  static void expect_same(const Ended& a, const Ended& b) {
    ASSERT_TRUE(a.state.over);
    ASSERT_TRUE(b.state.over);
    EXPECT_EQ(a.state.leader, b.state.leader);
    for (std::size_t i = 0; i < a.state.racers.size(); ++i) {
      EXPECT_EQ(a.state.racers[i].fate, b.state.racers[i].fate);
      EXPECT_EQ(a.state.racers[i].rounds, b.state.racers[i].rounds);
    }
    EXPECT_EQ(a.scores, b.scores);
  }

  Study study_ = test::example_study(24, "[0.1, 1, 5, 10, 3]");
  TuneSettings settings_;
  std::vector<Candidate> candidates_ = candidates_of(study_.file, settings_, "s.toml");
  std::filesystem::path folder_;
};

TEST_F(RaceSearches, OneAndTwoThreadsComeToTheSameEnd) {
  const Ended one = race("one", 1), two = race("two", 2);
  expect_same(one, two);
  const RaceCost cost =
      cost_of(study_, candidates_, one.state, study_results(study_, folder_ / "one"));
  EXPECT_LT(cost.trials, cost.grid_trials);
  EXPECT_EQ(cost.grid_trials, 5 * 24);
}

TEST_F(RaceSearches, AnInterruptedOneGoesOnToTheSameEnd) {
  const Ended whole = race("whole", 2);
  const Ended cut = race("cut", 1, 4);
  EXPECT_FALSE(cut.state.over);
  EXPECT_LT(cut.blocks, whole.blocks);
  expect_same(whole, race("cut", 2));
  EXPECT_EQ(race("cut", 2).blocks, 0);  // nothing is computed twice
}

// The store of a full grid holds all that a race needs.
TEST_F(RaceSearches, OnAWholeStudyItComputesNothing) {
  run_study(study_, {folder_ / "grid", 2, {}, {}, {}});
  const Ended on_grid = race("grid", 2);
  EXPECT_EQ(on_grid.blocks, 0);
  expect_same(race("alone", 2), on_grid);
}

TEST_F(RaceSearches, ACandidateIsJudgedOverItsConditions) {
  settings_.conditions = {"sources.calibration"};
  EXPECT_THROW(candidates_of(study_.file, settings_, "s.toml"), Error);
  // As two candidates of two conditions each.
  candidates_ = {{"a", {}, {0, 1}}, {"b", {}, {2, 3}}};
  const Ended ended = race("conditions", 2);
  ASSERT_TRUE(ended.state.over);
  const StudyResults results = study_results(study_, folder_ / "conditions");
  const int rounds = ended.state.racers[0].rounds;
  const CandidateFigures figures =
      figures_of(results, candidates_[0].cells, Objective::success, rounds);
  EXPECT_DOUBLE_EQ(figures.score, mean_score(ended.scores[0], rounds));
  EXPECT_EQ(figures.trials, 2 * 24);
  EXPECT_EQ(results.cells[4].trials.size(), 0u);
}

TEST_F(RaceSearches, TheDifferenceOfAStudyAndItselfIsNone) {
  run_study(study_, {folder_ / "grid", 2, {}, {}, {}});
  const StudyResults results = study_results(study_, folder_ / "grid");
  const ConfirmedDifference none = confirmed_difference(results, results, Objective::success);
  EXPECT_EQ(none.difference, 0);
  EXPECT_DOUBLE_EQ(*none.p_value, 1);
  ASSERT_TRUE(none.interval_95);
  EXPECT_LT(none.interval_95->low, 0);
  StudyResults fewer = results;
  fewer.cells.pop_back();
  EXPECT_THROW(confirmed_difference(results, fewer, Objective::success), Error);
}

// Conditions of one world share its recorded maps: one that changes nothing adds no evidence.
TEST_F(RaceSearches, ACopyOfAConditionNarrowsNothing) {
  run_study(study_, {folder_ / "grid", 2, {}, {}, {}});
  const StudyResults all = study_results(study_, folder_ / "grid");
  StudyResults a, b;
  a.cells = {all.cells[0]};
  b.cells = {all.cells[3]};
  const ConfirmedDifference once = confirmed_difference(a, b, Objective::success);
  const CandidateFigures figures = figures_of(a, {0}, Objective::success);
  for (StudyResults* results : {&a, &b}) results->cells.resize(6, results->cells[0]);
  const ConfirmedDifference copied = confirmed_difference(a, b, Objective::success);
  ASSERT_TRUE(once.interval_95);
  EXPECT_NEAR(copied.difference, once.difference, 1e-12);
  const auto width = [](const Interval& i) { return i.high - i.low; };
  EXPECT_NEAR(width(*copied.interval_95), width(*once.interval_95), 1e-12);
  const CandidateFigures six = figures_of(a, {0, 1, 2, 3, 4, 5}, Objective::success);
  EXPECT_EQ(six.maps, figures.maps);
  EXPECT_EQ(six.trials, 6 * figures.trials);
}

/// Twelve maps of 25 trials in a world, the first `wrong` of each wrong.
CellResult world_result(const std::string& world, int wrong) {
  CellResult result;
  result.cell.world = world;
  result.trials_per_block = 25;
  for (std::uint32_t t = 0; t < 300; ++t) {
    sim::TrialResult& trial = result.trials.emplace_back();
    trial.trial = t;
    trial.error = static_cast<int>(t % 25) < wrong ? 5 : 0;
    trial.status = localise::LocalisationStatus::answered;
  }
  return result;
}

TEST(Confirmation, WhatWorldsDifferByIsNoScatterOfMaps) {
  // Better by 5 of 25 in every map of one world, worse by 5 in every map of the other.
  StudyResults a, b;
  a.cells = {world_result("one", 0), world_result("two", 5)};
  b.cells = {world_result("one", 5), world_result("two", 0)};
  const ConfirmedDifference both = confirmed_difference(a, b, Objective::success);
  EXPECT_EQ(both.difference, 0);
  ASSERT_TRUE(both.interval_95);
  // The variance of independent trials is left: √(2 · 62) / 600 times Student's 2.07 with 22
  // degrees of freedom; over all 24 maps the half width was 0.086.
  EXPECT_NEAR(both.interval_95->high, std::sqrt(2 * 62.) / 600 * 2.074, 1e-4);
}

}  // namespace
}  // namespace vernier
