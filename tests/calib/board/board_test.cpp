// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "calib/board/board_pose.h"
#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

std::string complaint_of(BoardObservations observations) {
  return test::error_message([&] { check_and_sort(observations); });
}

class BadBoard : public testing::Test {
 protected:
  BoardObservations good_ = simulate_board(test::stereo_rig(), {}, {.seed = 1}).observations;
};

TEST_F(BadBoard, GoodOnesPass) { EXPECT_EQ(complaint_of(good_), ""); }

TEST_F(BadBoard, NonFiniteCornerIsNamed) {
  good_.views[3].pixels_px[7].x() = std::nan("");
  EXPECT_EQ(complaint_of(good_),
            "frame 1, camera 1, corner 7: its pixel is not a finite number; remove or correct it");
}

TEST_F(BadBoard, CornerOutsideTheImageIsNamed) {
  good_.views[0].pixels_px[2].x() = 640.2;
  EXPECT_NE(complaint_of(good_).find("frame 0, camera 0, corner 2: its pixel lies outside"),
            std::string::npos);
}

TEST_F(BadBoard, CameraTwiceInAFrameIsNamed) {
  good_.views[1].camera = 0;
  EXPECT_NE(complaint_of(good_).find("frame 0, camera 0: this camera appears twice"),
            std::string::npos);
}

TEST(SimulatedBoard, NoiseDiffersByTrialAndPosesDoNot) {
  const Rig rig = test::stereo_rig();
  const SimulatedBoard a = simulate_board(rig, {}, {.seed = 5}),
                       b = simulate_board(rig, {}, {.seed = 5, .trial = 1});
  EXPECT_EQ(a.truth.T_first_board[3].t, b.truth.T_first_board[3].t);
  EXPECT_NE(a.observations.views[3].pixels_px[0], b.observations.views[3].pixels_px[0]);
}

TEST_F(BadBoard, CornersWithoutAPoseAreAnError) {
  const Camera camera = test::stereo_rig().cameras[0];
  BoardView view = good_.views[0];
  view.ids.resize(3);
  view.pixels_px.resize(3);
  EXPECT_EQ(test::error_message([&] { board_pose(good_.target_m, view, camera); }),
            "frame 0, camera 0: no pose fits its corners; leave the view out");
}

TEST(EvenlySpaced, AreAsManyAsWantedAndTheFirstIsOneOfThem) {
  const std::vector<int> frames{2, 3, 5, 7, 11, 13, 17};
  EXPECT_EQ(evenly_spaced(frames, 3), (std::vector<int>{2, 5, 11}));
  EXPECT_EQ(evenly_spaced(frames, 6), (std::vector<int>{2, 3, 5, 7, 11, 13}));
  EXPECT_EQ(evenly_spaced(frames, 7), frames);
  EXPECT_EQ(evenly_spaced(frames, 100), frames);
  EXPECT_TRUE(evenly_spaced(frames, 0).empty());
}

}  // namespace
}  // namespace vernier
