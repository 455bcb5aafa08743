// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/held_out_boards.h"

#include <gtest/gtest.h>

#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/noise/corner_noise.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "tests/support/board_defects.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

// White noise, 40 views (seed 301): the bound is true, and so must be the intervals. The lengths of
// one split share its rig, so the share inside scatters more than a binomial's; 0.90 to 0.99 and a
// rms z of 0.85 to 1.15 hold for each of the seeds 301 to 310.
TEST(LeftOutBoards, IntervalsAreTrueWhereTheNoiseIsWhite) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 301, .frames = 40});
  const HeldOutBoardsResult result = evaluate_held_out_boards(
      board.observations, {.splits = 12, .calibration = {.model = Radial1{}}});
  EXPECT_EQ(result.splits, 12);
  EXPECT_EQ(result.boards, 12 * 19);
  for (const LengthCoverage& c : {result.edges, result.scale}) {
    EXPECT_GT(c.coverage_mvb, 0.90);
    EXPECT_LT(c.coverage_mvb, 0.99);
    EXPECT_NEAR(c.z_rms_mvb, 1, 0.15);
    EXPECT_GT(c.coverage_components, 0.88);
    EXPECT_NEAR(c.z_rms_components, 1, 0.2);
  }
  EXPECT_EQ(result.edges.lengths, 12 * 19 * (6 + 9 + 2));
}

// Boards that move between the exposures, with smooth errors. Of seeds 311 to 318, the rms z of the
// sizes is 1.07 to 1.75 with white noise, and 0.85 to 1.14 with the components (seed 318: 1.75 and
// 1.14).
TEST(LeftOutBoards, SizesAreTrueWithTheComponentsOfTheNoise) {
  const CornerNoise noise{.white_px = 0.1,
                          .field_px = 0.08,
                          .field_length_m = 0.05,
                          .motion_rad = 1e-3,
                          .motion_m = 5e-4};
  const auto board = test::noisy_board(test::stereo_rig(), {}, {.seed = 318, .frames = 40}, noise);
  const HeldOutBoardsResult result = evaluate_held_out_boards(
      board.board.observations, {.splits = 10, .calibration = {.model = Radial1{}}});
  EXPECT_EQ(result.noise_not_found, 0);
  EXPECT_GT(result.scale.z_rms_honest, 1.4);
  EXPECT_LT(result.scale.coverage_honest, 0.88);
  EXPECT_GT(result.scale.z_rms_components, 0.75);
  EXPECT_LT(result.scale.z_rms_components, 1.3);
  EXPECT_GT(result.scale.coverage_components, 0.88);
  EXPECT_GT(result.edges.coverage_components, 0.90);
  EXPECT_LT(result.edges.coverage_components, 0.99);
}

TEST(LeftOutBoards, WrongModelIsSeen) {
  Rig truth = test::stereo_rig(OpenCv4{});
  for (Camera& camera : truth.cameras) camera.parameters[6] = 4e-3;  // p1
  const auto board = simulate_board(truth, {}, {.seed = 302, .frames = 30, .pixel_sigma_px = 0.05});
  const auto with = [&](const CameraModel& model) {
    return evaluate_held_out_boards(board.observations,
                                    {.splits = 6, .calibration = {.model = model}})
        .scale.z_rms_mvb;
  };
  EXPECT_GT(with(Radial1{}), 2 * with(OpenCv4{}));
}

// A corner whose rays part: it alone is left out and counted, and a board of too few corners is.
TEST(LeftOutBoards, CornersWithoutAPointAreCounted) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 305, .frames = 14});
  const auto measured = [&](const BoardObservations& observations) {
    return evaluate_held_out_boards(
        observations,
        {.splits = 8, .calibration = {.held = {{"left.ax", 1.002}}, .check_input = false}});
  };
  const HeldOutBoardsResult clean = measured(board.observations);
  EXPECT_EQ(clean.boards, 8 * 6);
  EXPECT_EQ(clean.corners_left_out + clean.boards_left_out, 0);
  BoardObservations clean_views = board.observations, spoilt = board.observations;
  BoardView& one = test::view_of(spoilt, 3, 1);
  for (const std::size_t i : {0u, 20u}) one.pixels_px[i].x() = 639;
  BoardView& other = test::view_of(spoilt, 8, 1);
  other.ids = {0, 8, 45, 53, 13, 31};
  other.pixels_px = {};
  const BoardView& whole = test::view_of(clean_views, 8, 1);
  for (const int id : other.ids) other.pixels_px.push_back(whole.pixels_px[id]);
  for (std::size_t i = 3; i < 6; ++i) other.pixels_px[i].x() = 639;
  const HeldOutBoardsResult result = measured(spoilt);
  EXPECT_EQ(result.splits, 8);
  EXPECT_GT(result.boards_left_out, 0);
  EXPECT_LT(result.boards_left_out, 8);
  EXPECT_EQ(result.boards, clean.boards - result.boards_left_out);
  // frame 3 was left out by some splits, with two corners less each time
  const int of_frame_3 = result.corners_left_out - 3 * result.boards_left_out;
  EXPECT_GT(of_frame_3, 0);
  EXPECT_EQ(of_frame_3 % 2, 0);
  EXPECT_LE(of_frame_3, 16);
  EXPECT_NEAR(result.scale.z_rms_mvb, clean.scale.z_rms_mvb, 0.7);
}

TEST(LeftOutBoards, NeedAPairAndViews) {
  auto observations =
      simulate_board(test::stereo_rig(), {}, {.seed = 303, .frames = 5}).observations;
  EXPECT_THROW(evaluate_held_out_boards(observations), Error);
  observations = simulate_board(test::stereo_rig(), {}, {.seed = 303, .frames = 8}).observations;
  EXPECT_THROW(evaluate_held_out_boards(observations, {.training_frames = 8}), Error);
}

}  // namespace
}  // namespace vernier
