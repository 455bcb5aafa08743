// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/tilt_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/observation_checks.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/simulated_board.h"
#include "calib/solver/initial_rig.h"
#include "tests/support/board_defects.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

std::string tilt_complaint(BoardObservations observations) {
  check_and_sort(observations);
  const std::vector<CameraModel> models(observations.size_px.size(), Radial1{});
  const BoardState start = initial_state(observations, models);
  try {
    const ObservationDiagnosis diagnosis = check_tilts(observations, start);
    return diagnosis.trust_warnings.empty() ? "" : "doubt: " + diagnosis.trust_warnings[0];
  } catch (const Error& error) {
    return error.what();
  }
}

class BoardTilts : public testing::TestWithParam<std::uint64_t> {};

TEST_P(BoardTilts, BoardsAllParallelToTheImageAreNamed) {
  const auto flat =
      simulate_board(test::stereo_rig(), {}, {.seed = GetParam(), .frames = 12, .tilt_rad = 0.0});
  // simulate_board turns the board about the axis too, which is no tilt
  const std::string error_output = tilt_complaint(flat.observations);
  EXPECT_NE(error_output.find(
                ": every board is parallel to the image, or nearly so, which leaves the "
                "focal length undetermined; tilt the board by 20 to 45 degrees about both axes"),
            std::string::npos)
      << error_output;
}

TEST_P(BoardTilts, TwoTiltsAreTooFew) {
  const auto two =
      test::board_at_tilts(test::stereo_rig(), {}, GetParam(), {{0.4, 0.1, 0}, {-0.1, -0.5, 0.2}});
  EXPECT_EQ(
      tilt_complaint(two).find("camera 0: its 12 views show the board at only 2 distinct tilts"),
      0u)
      << tilt_complaint(two);
}

TEST_P(BoardTilts, ThreeTiltsAreEnough) {
  const auto three = test::board_at_tilts(test::stereo_rig(), {}, GetParam(),
                                          {{0.4, 0.1, 0}, {-0.1, -0.5, 0.2}, {-0.3, 0.3, 0}});
  EXPECT_EQ(tilt_complaint(three), "");
}

INSTANTIATE_TEST_SUITE_P(Seeds, BoardTilts, testing::Range<std::uint64_t>(300, 320));

// By all checks together, at noise in which some sets seem tilted: of 600 sets of other seeds, at
// 0.2 and 0.5 px, 7 were trusted, one of them with a focal length off by more than 3 of its
// standard deviations. False alarm 1e-3 at 1 % trusted.
TEST(ParallelBoards, AreHardlyEverTrusted) {
  int trusted = 0;
  for (std::uint64_t seed = 5300; seed < 5360; ++seed) {
    const SimulatedBoard flat =
        simulate_board(test::stereo_rig(), {},
                       {.seed = seed, .frames = 12, .pixel_sigma_px = 0.5, .tilt_rad = 0.0});
    try {
      trusted += calibrate(flat.observations).calibration->trust_warnings.empty();
    } catch (const Error&) {  // refused
    }
  }
  EXPECT_LE(trusted, 4);
}

TEST(DistinctTilts, CountNormalsThatStandApart) {
  const auto normal = [](double angle) {
    return Eigen::Vector3d(std::sin(angle), 0, std::cos(angle));
  };
  EXPECT_EQ(distinct_tilts({normal(0), normal(0.01), normal(0.3), normal(0.31)}), 2);
  EXPECT_EQ(distinct_tilts({normal(0), normal(0.2), normal(0.4)}), 3);
  EXPECT_EQ(distinct_tilts({}), 0);
}

}  // namespace
}  // namespace vernier
