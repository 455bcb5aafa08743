// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/board_tests.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "calib/calibrate.h"
#include "calib/simulated_board.h"
#include "tests/support/bent_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

const CalibrationOptions plain{.reject_outliers = false, .check_input = false};

SimulatedBoard few_views(int frames, std::uint32_t trial = 0) {
  return simulate_board(test::stereo_rig(), {},
                        {.seed = 841, .trial = trial, .poses = trial, .frames = frames});
}

/// The target's points displaced by the fields, each by its amount.
std::vector<Eigen::Vector3d> displaced(std::vector<Eigen::Vector3d> target_m,
                                       const std::vector<BoardField>& fields,
                                       const Eigen::VectorXd& amounts) {
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      target_m[i] +=
          amounts[static_cast<Eigen::Index>(k)] * fields[k].col(static_cast<Eigen::Index>(i));
    }
  }
  return target_m;
}

TEST(BoardTests, BendsAreParabolasOverTheTarget) {
  const std::vector<Eigen::Vector3d> target_m = target_points(Chessboard{3, 3, 0.1});
  const std::vector<BoardField> fields = bend_fields(target_m);
  ASSERT_EQ(fields.size(), 3U);
  for (int i = 0; i < 9; ++i) {
    const double x = i % 3 - 1, y = i / 3 - 1;
    EXPECT_NEAR(fields[0](2, i), 1 - x * x, 1e-12);
    EXPECT_NEAR(fields[1](2, i), 1 - y * y, 1e-12);
    EXPECT_NEAR(fields[2](2, i), x * y, 1e-12);
    for (const BoardField& field : fields) EXPECT_TRUE(field.col(i).head<2>().isZero(0));
  }
}

// A cylinder in any direction is found in four views, with its size: of a squared distance of three
// degrees of freedom above 22.5, one in 20 000.
TEST(BoardTests, FindABendInFourViewsWithItsSize) {
  for (const Eigen::Vector3d& amounts :
       {Eigen::Vector3d(1e-3, 0, 0), Eigen::Vector3d(3e-4, -8e-4, 0),
        Eigen::Vector3d(6e-4, 4e-4, -1e-3)}) {
    const SimulatedBoard board = few_views(4);
    const auto fields = bend_fields(board.observations.target_m);
    const BoardObservations bent =
        test::of_points(board, displaced(board.observations.target_m, fields, amounts));
    const BoardTest test = board_test(calibrate(bent, plain), fields);
    EXPECT_LT(test.p_value, 1e-4);
    const Eigen::Vector3d error = test.value - amounts;
    EXPECT_LT(error.dot(test.covariance.inverse() * error), 22.5) << test.value.transpose();
    EXPECT_LT(test.covariance.diagonal().cwiseSqrt().maxCoeff(), 3e-4);
  }
}

// Of 20 flat boards of 4 to 7 views, with a false alarm in 1.5 % of them, three or more: one in
// 300.
TEST(BoardTests, LeaveFlatBoardsFlat) {
  int found = 0;
  double sum = 0;
  for (std::uint32_t t = 0; t < 20; ++t) {
    const SimulatedBoard board = few_views(4 + static_cast<int>(t % 4), t);
    const auto fields = bend_fields(board.observations.target_m);
    const BoardTest test = board_test(calibrate(board.observations, plain), fields);
    found += test.p_value < 0.01;
    sum += test.chi2;
    EXPECT_EQ(test.value.size(), 3);
  }
  EXPECT_LT(found, 3);
  // 60 degrees of freedom: 99.8 % between these
  EXPECT_GT(sum, 32);
  EXPECT_LT(sum, 1.15 * 99.6);
}

}  // namespace
}  // namespace vernier
