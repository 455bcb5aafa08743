// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <string>

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

TEST_F(BadBoard, IdsAndPixelsThatDifferInNumberAreNamed) {
  good_.views[0].ids.pop_back();
  EXPECT_EQ(complaint_of(good_),
            "frame 0, camera 0: 54 pixels for 53 corners; give one pixel per corner");
}

TEST_F(BadBoard, ARepeatedCornerIsNamed) {
  good_.views[0].ids[5] = 4;
  EXPECT_EQ(complaint_of(good_),
            "frame 0, camera 0, corner 4: it appears twice in the view; give it once");
}

TEST_F(BadBoard, ATargetThatIsNotFiniteIsNamed) {
  good_.target_m[2].x() = std::nan("");
  EXPECT_EQ(complaint_of(good_),
            "target, corner 2: its position is not a finite number; give it in metres");
}

TEST(SimulatedBoard, BadArgumentsAreRefused) {
  const Rig rig = test::stereo_rig();
  const auto complaint = [&](const Chessboard& board, const SimulatedBoardOptions& options) {
    return test::error_message([&] { simulate_board(rig, board, options); });
  };
  for (const int side : {-3, 0, 1, 1001, 2'000'000'000}) {
    EXPECT_EQ(complaint({.columns = side}, {}),
              std::to_string(side) +
                  "x6 board: fewer than 2 or more than 1000 along a side; count the inner corners");
    EXPECT_NE(complaint({.rows = side}, {}), "");
  }
  EXPECT_NE(complaint({.columns = 2'000'000'000, .rows = 2'000'000'000}, {}), "");
  EXPECT_NE(complaint({.square_m = std::nan("")}, {}), "");
  EXPECT_NE(complaint({.row_m = -1}, {}), "");
  EXPECT_EQ(complaint({}, {.frames = 0}), "simulated board: 0 frames; give 1 to 100000");
  EXPECT_NE(complaint({}, {.frames = -1}), "");
  EXPECT_EQ(complaint({}, {.pixel_sigma_px = std::nan("")}),
            "simulated board: pixel noise of nan px; give 0 or more");
  EXPECT_NE(complaint({}, {.pixel_sigma_px = -1}), "");
  EXPECT_EQ(complaint({}, {.distance_m = std::nan("")}),
            "simulated board: a distance of nan m; give a number above 0");
  EXPECT_NE(complaint({}, {.distance_m = 0}), "");
  EXPECT_NE(complaint({}, {.tilt_rad = std::nan("")}), "");
}

TEST(SimulatedBoard, RigsThatLackSomethingAreRefused) {
  const auto complaint = [](const Rig& rig) {
    return test::error_message([&] { simulate_board(rig, {}); });
  };
  EXPECT_EQ(complaint({}), "simulated board: the rig has no camera; give one");
  Rig rig = test::stereo_rig();
  rig.T_camera_first.clear();
  EXPECT_NE(complaint(rig).find("lacks a pose"), std::string::npos);
  rig = test::stereo_rig();
  rig.cameras[0].parameters[0] = std::nan("");
  EXPECT_NE(complaint(rig).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace vernier
