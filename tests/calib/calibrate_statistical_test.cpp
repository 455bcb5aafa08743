// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "calib/calibrate.h"
#include "calib/simulated_board.h"
#include "tests/support/chi_squared.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

// 150 calibrations of the same 15 views with fresh noise, seed 21. The normalised estimation error
// squared, summed, is chi-squared with 150 x 16 degrees of freedom; false-alarm rate 1 %,
// two-sided.
TEST(Calibrate, NormalisedErrorIsChiSquared) {
  const Rig truth = test::stereo_rig();
  const int trials = 150;
  double nees = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const auto board =
        simulate_board(truth, {7, 6, 0.035}, 21, trial, {.frames = 15, .pixel_sigma_px = 0.2});
    const RigEstimate estimate = calibrate(board.observations, {.pixel_sigma_px = 0.2});
    const Eigen::VectorXd e = difference(estimate.rig, truth);
    nees += e.dot(Eigen::LLT<Eigen::MatrixXd>(*estimate.covariance_mvb).solve(e));
  }
  EXPECT_GT(nees, test::chi_squared_quantile(16 * trials, 0.005));
  EXPECT_LT(nees, test::chi_squared_quantile(16 * trials, 0.995));
}

}  // namespace
}  // namespace vernier
