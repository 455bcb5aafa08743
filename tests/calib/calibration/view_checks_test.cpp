// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/view_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/observation_checks.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/minimise_reprojection.h"
#include "tests/support/board_defects.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

ObservationDiagnosis view_diagnosis(BoardObservations observations) {
  check_and_sort(observations);
  const std::vector<CameraModel> models(observations.size_px.size(), Radial1{});
  return check_views(observations, initial_state(observations, models));
}

std::string view_complaint(const BoardObservations& observations) {
  return test::error_message([&] { view_diagnosis(observations); });
}

/// Every defect on sets of two sizes of noise and several seeds.
class ViewChecks : public testing::TestWithParam<std::uint64_t> {
 protected:
  BoardObservations good_ =
      simulate_board(
          test::stereo_rig(),
          {},
          {.seed = GetParam(), .frames = 13, .pixel_sigma_px = GetParam() % 2 ? 0.2 : 0.5})
          .observations;
};

TEST_P(ViewChecks, GoodOnesPassInSilence) {
  const ObservationDiagnosis diagnosis = view_diagnosis(good_);
  EXPECT_TRUE(diagnosis.trust_warnings.empty());
  EXPECT_TRUE(diagnosis.frame_doubts.empty());
  EXPECT_TRUE(diagnosis.warnings.empty());
}

TEST_P(ViewChecks, OneTurnedViewIsNamed) {
  BoardView& view = test::view_of(good_, 7, 1);
  test::half_turn(view);
  view.image = "right07.png";
  const std::string error_output = view_complaint(good_);
  EXPECT_EQ(
      error_output.find("frame 7, camera 1 (right07.png): its corners are numbered half a turn "
                        "(180 degrees) away from those of camera 0"),
      0u)
      << error_output;
  EXPECT_NE(error_output.find("; reverse the order of its corners or leave the frame out"),
            std::string::npos);
}

TEST_P(ViewChecks, SeveralTurnedViewsOfTheFirstCameraAreCounted) {
  for (const int frame : {2, 5, 11}) test::half_turn(test::view_of(good_, frame, 0));
  const std::string error_output = view_complaint(good_);
  EXPECT_EQ(error_output.find("frame 2, camera 0: its corners are numbered half a turn"), 0u)
      << error_output;
  EXPECT_NE(error_output.find("(and 2 more frames like it)"), std::string::npos) << error_output;
}

TEST_P(ViewChecks, ACameraTurnedThroughoutIsNamed) {
  for (BoardView& view : good_.views) {
    if (view.camera == 1) test::half_turn(view);
  }
  EXPECT_EQ(
      view_complaint(good_),
      "camera 1: its corners are numbered half a turn (180 degrees) away from those of camera "
      "0 in 13 of 13 frames; reverse the order of the corners in one of the two cameras, or turn "
      "its images by "
      "180 degrees");
}

TEST_P(ViewChecks, BothCamerasTurnedInAFrameIsNoFault) {
  for (const int camera : {0, 1}) test::half_turn(test::view_of(good_, 7, camera));
  EXPECT_TRUE(view_diagnosis(good_).trust_warnings.empty());
}

TEST_P(ViewChecks, SwappedViewsAreNamed) {
  test::view_of(good_, 3, 0).image = "left03.png";
  for (const int frame : {3, 8}) test::exchange(good_, frame);
  const std::string error_output = view_complaint(good_);
  EXPECT_EQ(
      error_output.find("frame 3, camera 0 (left03.png) and frame 3, camera 1: left and right "
                        "are swapped against the other frames"),
      0u)
      << error_output;
  EXPECT_NE(error_output.find("(and 1 more frame like it); exchange the two images"),
            std::string::npos)
      << error_output;
}

TEST_P(ViewChecks, CamerasExchangedThroughoutAreDoubted) {
  for (int frame = 0; frame < 13; ++frame) test::exchange(good_, frame);
  const ObservationDiagnosis diagnosis = view_diagnosis(good_);
  ASSERT_EQ(diagnosis.trust_warnings.size(), 1u);
  EXPECT_EQ(diagnosis.trust_warnings[0].find("camera 1 (\"right\") is 0."), 0u)
      << diagnosis.trust_warnings[0];
  EXPECT_NE(diagnosis.trust_warnings[0].find(
                "m to the left of camera 0 (\"left\"): the cameras seem to be "
                "exchanged"),
            std::string::npos);
}

TEST_P(ViewChecks, ImagesPairedOneFrameLateAreNamed) {
  for (BoardView& view : good_.views) {
    if (view.camera == 1) ++view.frame;
  }
  const std::string error_output = view_complaint(good_);
  EXPECT_EQ(error_output.find("cameras 0 and 1: their images are paired wrongly"), 0u)
      << error_output;
  EXPECT_NE(error_output.find("13 of 13 do when camera 1's images are taken 1 frame later"),
            std::string::npos)
      << error_output;
}

TEST_P(ViewChecks, ImagesWithoutAnyPairingAreNamed) {
  for (BoardView& view : good_.views) {
    if (view.camera == 1) view.frame = view.frame * 5 % 13;
  }
  const std::string error_output = view_complaint(good_);
  EXPECT_EQ(error_output.find("cameras 0 and 1: only "), 0u) << error_output;
  EXPECT_NE(
      error_output.find("of 13 frames agree on the pose between the two: their images are not "
                        "simultaneous"),
      std::string::npos)
      << error_output;
}

TEST_P(ViewChecks, ImagesExchangedBetweenTwoFramesAreNamed) {
  std::swap(test::view_of(good_, 2, 1).pixels_px, test::view_of(good_, 9, 1).pixels_px);
  const std::string error_output = view_complaint(good_);
  EXPECT_EQ(
      error_output.find("frame 2, camera 1 and frame 9, camera 1: each belongs to the other frame"),
      0u)
      << error_output;
}

TEST_P(ViewChecks, OneFrameTakenAtOtherTimesIsDoubted) {
  test::view_of(good_, 6, 1).pixels_px = test::view_of(good_, 5, 1).pixels_px;
  for (auto& p : test::view_of(good_, 6, 1).pixels_px) p.x() += 1;  // not the same view
  const ObservationDiagnosis diagnosis = view_diagnosis(good_);
  ASSERT_EQ(diagnosis.frame_doubts.size(), 1u);
  const auto& [frame, text] = diagnosis.frame_doubts[0];
  EXPECT_EQ(frame, 6);
  EXPECT_EQ(text.find("frame 6, camera 1: each image fits the board to "), 0u) << text;
  EXPECT_NE(text.find("leave the frame out"), std::string::npos);
  // the solution does not refute it
  const RigEstimate estimate = calibrate(good_);
  const std::vector<std::string>& doubts = estimate.calibration->trust_warnings;
  EXPECT_NE(std::find(doubts.begin(), doubts.end(), text), doubts.end());
}

TEST_P(ViewChecks, ASoundSolutionRefutesADoubt) {
  check_and_sort(good_);
  const BoardState end = minimise_reprojection(good_, initial_state(good_, {Radial1{}, Radial1{}}));
  const std::vector<FrameDoubt> doubts{{6, "of a sound frame"}, {99, "of one that was left out"}};
  EXPECT_EQ(unrefuted(doubts, good_, end, {}), std::vector<std::string>{doubts[1].text});
  const std::vector<CornerOutlier> outliers{{6, 1, 3, "", {0, 0}, 9}};
  EXPECT_EQ(unrefuted(doubts, good_, end, outliers).size(), 2u);
  for (auto& p : test::view_of(good_, 6, 1).pixels_px) p.x() += 2;
  EXPECT_EQ(unrefuted(doubts, good_, end, {}).size(), 2u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ViewChecks, testing::Range<std::uint64_t>(400, 410));

}  // namespace
}  // namespace vernier
