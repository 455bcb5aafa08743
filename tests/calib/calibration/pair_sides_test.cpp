// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/pair_sides.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "calib/estimate/simulated_pairs.h"
#include "calib/joint_calibration.h"
#include "calib/pair_observations.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "tests/support/error_message.h"
#include "tests/support/pair_priors.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

PairObservations exchanged(PairObservations pairs) {
  for (Eigen::Vector4d& y : pairs.pixels_px) y = Eigen::Vector4d(y[2], y[3], y[0], y[1]);
  return pairs;
}

/// A datasheet that knows the rotation to 0.06 rad only, which check_sides cannot use.
GaussianRigPrior loose(const Rig& truth, std::uint32_t trial) {
  GaussianRigPrior known = test::datasheet(truth, 41, trial);
  for (int i = 0; i < 3; ++i) {
    const int at = pose_index(truth, 1) + i;
    known.covariance.matrix(at, at) = 0.06 * 0.06;
  }
  return known;
}

// Twenty fixed draws: the right ones have no doubt of their sides, the exchanged ones are refused.
TEST(PairSides, TheSolvedRigTellsWhatAnApproximateOneCannot) {
  const Rig truth = test::stereo_rig();
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    const PairObservations pairs = simulate_pairs(truth, 42, trial, {.image_pairs = 8});
    const GaussianRigPrior known = loose(truth, trial);
    EXPECT_EQ(judge_sides(pairs, known), SideVerdict::as_given) << trial;
    const std::string said =
        test::error_message([&] { calibrate_from_pairs(exchanged(pairs), known); });
    EXPECT_NE(said.find("left and right are swapped"), std::string::npos) << trial << said;
  }
}

TEST(PairSides, OfADistantSceneNothingTellsThem) {
  Rig truth = test::stereo_rig();
  truth.T_camera_first[1].R.setIdentity();
  const PairObservations pairs =
      simulate_pairs(truth, 43, 0, {.image_pairs = 8, .nearest_m = 300, .farthest_m = 900});
  for (const PairObservations& read : {pairs, exchanged(pairs)}) {
    EXPECT_EQ(judge_sides(read, loose(truth, 0)), SideVerdict::interchangeable);
  }
}

TEST(PairSides, CountedByTheCornersBeforeAndBehindTheRig) {
  const Rig truth = test::stereo_rig();
  const PairObservations pairs = simulate_pairs(truth, 44, 0, {.image_pairs = 5});
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(16, 16);
  const SideCounts right = count_sides(pairs, truth, none);
  EXPECT_EQ(right.judged, 5u);
  EXPECT_EQ(right.right, 5u);
  EXPECT_TRUE(right.swapped.empty());
  EXPECT_EQ(count_sides(exchanged(pairs), truth, none).swapped.size(), 5u);
}

}  // namespace
}  // namespace vernier
