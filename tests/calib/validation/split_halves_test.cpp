// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/split_halves.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>

#include "calib/board_observations.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/simulated_board.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

SplitHalvesResult halves(std::uint64_t seed, int splits, int threads = 0) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = seed, .frames = 16});
  return compare_split_halves(
      board.observations,
      {.splits = splits, .seed = seed, .threads = threads, .calibration = {.model = Radial1{}}});
}

// One split of each of 60 sets of white noise: by the bound the sum of squared distances is
// chi-squared. False alarms: 2 in 1000 (seeds 401 to 460).
TEST(SplitHalves, DistanceByTheBoundIsChiSquaredWhereTheNoiseIsWhite) {
  double sum = 0;
  int dof = 0;
  for (std::uint64_t seed = 401; seed <= 460; ++seed) {
    const SplitHalvesResult result = halves(seed, 1);
    ASSERT_EQ(result.splits, 1);
    EXPECT_EQ(result.dof, 16);
    sum += result.nees_mean_mvb;
    dof += result.dof;
  }
  EXPECT_GT(sum, chi_squared_quantile(1e-3, dof));
  EXPECT_LT(sum, chi_squared_quantile(1 - 1e-3, dof));
}

// The board moved between the exposures of a pair (seed 461): the right image of each view is off
// by 0.5 px in each direction. The bound takes that for many independent errors, the honest
// covariance does not.
TEST(SplitHalves, ErrorsThatAViewSharesAreSeenByTheBoundAlone) {
  auto board = simulate_board(test::stereo_rig(), {}, {.seed = 461, .frames = 40});
  for (BoardView& view : board.observations.views) {
    if (view.camera != 1) continue;
    RandomStream draws({.seed = 461, .trial = static_cast<std::uint32_t>(view.frame)});
    const Eigen::Vector2d shift{0.5 * draws.normal(), 0.5 * draws.normal()};
    for (Eigen::Vector2d& pixel : view.pixels_px) pixel += shift;
  }
  const SplitHalvesResult result = compare_split_halves(
      board.observations,
      {.splits = 10, .calibration = {.model = Radial1{}, .check_input = false}});
  EXPECT_GT(result.nees_mean_mvb, 3 * result.dof);
  EXPECT_LT(result.inside_95_mvb, 0.5);
  EXPECT_LT(result.nees_mean_honest, 2 * result.dof);
  EXPECT_GT(result.nees_mean_honest, 0.4 * result.dof);
}

TEST(SplitHalves, DoNotDependOnThreads) {
  const SplitHalvesResult one = halves(462, 6, 1), three = halves(462, 6, 3);
  ASSERT_EQ(one.distances.size(), 6u);
  for (std::size_t i = 0; i < one.distances.size(); ++i) {
    EXPECT_EQ(one.distances[i].honest, three.distances[i].honest);
    EXPECT_EQ(one.distances[i].mvb, three.distances[i].mvb);
    EXPECT_NE(one.distances[i].honest, one.distances[(i + 1) % 6].honest);
  }
}

TEST(SplitHalves, FewFramesAreRefused) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 463, .frames = 5});
  EXPECT_THROW(compare_split_halves(board.observations), Error);
}

// Both halves would have it, and their difference is smaller than their covariances state.
TEST(SplitHalves, APriorIsRefused) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 464, .frames = 12});
  CalibrationOptions how{.model = Radial1{}};
  how.known = {{"left.f_px", test::stereo_rig().cameras[0].f_px(), 5}};
  EXPECT_THROW(compare_split_halves(board.observations, {.splits = 2, .calibration = how}), Error);
}

}  // namespace

}  // namespace vernier
