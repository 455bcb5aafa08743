// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/left_out_boards.h"

#include <gtest/gtest.h>

#include "calib/error.h"
#include "calib/model_comparison.h"
#include "calib/simulated_board.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

// White noise, 40 views (seed 301): the bound is true, and so must be the intervals. The lengths of
// one split share its rig, so the share inside scatters more than a binomial's; 0.90 to 0.99 and a
// rms z of 0.85 to 1.15 hold for each of the seeds 301 to 310.
TEST(LeftOutBoards, IntervalsAreTrueWhereTheNoiseIsWhite) {
  const auto board = simulate_board(test::stereo_rig(), {}, 301, 0, {.frames = 40});
  const LeftOutBoardsResult result = measure_left_out_boards(
      board.observations, {.splits = 12, .calibration = {.model = Radial1{}}});
  EXPECT_EQ(result.splits, 12);
  EXPECT_EQ(result.boards, 12 * 19);
  for (const LengthCoverage& c : {result.edges, result.scale}) {
    EXPECT_GT(c.coverage_mvb, 0.90);
    EXPECT_LT(c.coverage_mvb, 0.99);
    EXPECT_NEAR(c.z_rms_mvb, 1, 0.15);
  }
  EXPECT_EQ(result.edges.lengths, 12 * 19 * (6 + 9 + 2));
}

TEST(LeftOutBoards, WrongModelIsSeen) {
  Rig truth = test::stereo_rig(OpenCv4{});
  for (Camera& camera : truth.cameras) camera.parameters[6] = 4e-3;  // p1
  const auto board = simulate_board(truth, {}, 302, 0, {.frames = 30, .pixel_sigma_px = 0.05});
  const auto with = [&](const CameraModel& model) {
    return measure_left_out_boards(board.observations,
                                   {.splits = 6, .calibration = {.model = model}})
        .scale.z_rms_mvb;
  };
  EXPECT_GT(with(Radial1{}), 2 * with(OpenCv4{}));
}

TEST(LeftOutBoards, NeedAPairAndViews) {
  auto observations = simulate_board(test::stereo_rig(), {}, 303, 0, {.frames = 5}).observations;
  EXPECT_THROW(measure_left_out_boards(observations), Error);
  observations = simulate_board(test::stereo_rig(), {}, 303, 0, {.frames = 8}).observations;
  EXPECT_THROW(measure_left_out_boards(observations, {.training_frames = 8}), Error);
}

TEST(ModelComparison, NamesTheModelThatPredictsBetter) {
  Rig truth = test::stereo_rig(OpenCv4{});
  const auto board = simulate_board(truth, {}, 304, 0, {.frames = 16, .pixel_sigma_px = 0.1});
  const CalibrationOptions options{.model = Radial1{}};
  const ModelComparison c = compare_models(calibrate(board.observations, options), options);
  ASSERT_EQ(c.richer.size(), 2u);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("use --model opencv4"), std::string::npos) << c.warnings[0];
  EXPECT_LT(c.richer[0].held_out_rms_px, c.in_use.held_out_rms_px);
  EXPECT_GT(c.richer[0].better_views, 12);
}

// 20 sets whose model is right: a warning would come once in 700 models (two a set).
TEST(ModelComparison, IsSilentWhereTheModelIsRight) {
  for (std::uint64_t seed = 320; seed < 340; ++seed) {
    const auto board = simulate_board(test::stereo_rig(), {}, seed, 0, {.frames = 13});
    const CalibrationOptions options{.model = Radial1{}};
    const ModelComparison c = compare_models(calibrate(board.observations, options), options);
    EXPECT_TRUE(c.warnings.empty()) << c.warnings[0];
  }
}

}  // namespace
}  // namespace vernier
