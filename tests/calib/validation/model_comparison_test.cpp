// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/model_comparison.h"

#include <gtest/gtest.h>

#include <set>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/calibration_problem.h"
#include "calib/covariance.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/minimise_reprojection.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

ModelComparison compared(const BoardObservations& observations, const CalibrationOptions& options) {
  return compare_models(calibrate(observations, options), options);
}

TEST(ModelComparison, NamesTheModelThatPredictsBetter) {
  const Rig truth = test::stereo_rig(OpenCv4{});
  const auto board = simulate_board(truth, {}, {.seed = 304, .frames = 16, .pixel_sigma_px = 0.1});
  const ModelComparison c = compared(board.observations, {.model = Radial1{}});
  ASSERT_EQ(c.richer.size(), 2u);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("use --model opencv4"), std::string::npos) << c.warnings[0];
  EXPECT_LT(c.richer[0].held_out_rms_px, c.in_use.held_out_rms_px);
  EXPECT_GT(c.richer[0].better_views, 12);
}

// 20 sets whose model is right: a warning would come once in 700 models (two a set).
TEST(ModelComparison, IsSilentWhereTheModelIsRight) {
  for (std::uint64_t seed = 320; seed < 340; ++seed) {
    const auto board = simulate_board(test::stereo_rig(), {}, {.seed = seed, .frames = 13});
    const ModelComparison c = compared(board.observations, {.model = Radial1{}});
    EXPECT_TRUE(c.warnings.empty()) << c.warnings[0];
  }
}

/// The right camera sees the board in the frames given alone.
BoardObservations seldom_seen(const std::set<int>& frames) {
  BoardObservations seen =
      simulate_board(test::stereo_rig(), {}, {.seed = 306, .frames = 24}).observations;
  std::erase_if(seen.views, [&](const BoardView& view) {
    return view.camera == 1 && !frames.contains(view.frame);
  });
  return seen;
}

// Frames are dealt so that those in which a camera saw the board do not leave together.
TEST(ModelComparison, ACameraThatSeldomSawTheBoardIsComparedAsTheOthersAre) {
  for (const std::vector<HeldParameter>& held :
       {std::vector<HeldParameter>{}, {{"right.k1", -0.132}}}) {
    const ModelComparison c = compared(seldom_seen({0, 8, 16, 23}), {.held = held});
    EXPECT_EQ(c.not_compared, "");
    ASSERT_EQ(c.richer.size(), 2u);
    EXPECT_NEAR(c.in_use.held_out_rms_px, 0.2, 0.02);
    EXPECT_LT(c.richer[0].held_out_rms_px, 1);  // from three views
    EXPECT_TRUE(c.warnings.empty());
  }
}

// Of 60 frames out of 140 none is one in which the right camera saw anything.
TEST(ModelComparison, SaysWhyItComparesNothing) {
  BoardObservations seen =
      simulate_board(test::stereo_rig(), {4, 3, 0.05}, {.seed = 307, .frames = 140}).observations;
  std::erase_if(seen.views, [&](const BoardView& view) {
    return view.camera == 1 && view.frame != 1 && view.frame != 6 && view.frame != 8;
  });
  const CalibrationOptions options{.held = {{"right.k1", -0.132}}};
  const ModelComparison c = compared(seen, options);
  EXPECT_EQ(c.not_compared.find(
                "with some views left out, camera 1 (\"right\"): it has no view of the board"),
            0u)
      << c.not_compared;
  EXPECT_TRUE(c.richer.empty());
  EXPECT_TRUE(c.warnings.empty());
}

/// What is said of a calibration from left images alone, the right camera being known from
/// elsewhere.
ModelComparison compared_by_left_images(bool held) {
  Rig truth = test::stereo_rig();
  truth.cameras[1].model = OpenCv8{};  // no model is richer
  truth.cameras[1].parameters = test::stereo_rig(OpenCv8{}).cameras[1].parameters;
  auto board = simulate_board(truth, {}, {.seed = 308, .frames = 16});
  std::erase_if(board.observations.views, [](const BoardView& view) { return view.camera == 1; });
  CalibrationOptions options{.pixel_sigma_px = 0.2};
  const std::vector<std::string> names = parameter_names(truth);
  const Eigen::VectorXd values = parameters(truth);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double value = values[static_cast<Eigen::Index>(i)];
    if (!names[i].starts_with("right.")) continue;
    if (held) options.held.push_back({names[i], value});
    if (!held) options.known.push_back({names[i], value, 1e-3});
  }
  const BoardState state =
      minimise_reprojection(board.observations, board.truth, problem_of(options, truth));
  RigEstimate estimate;
  estimate.rig = state.rig;
  const auto n = values.size();
  estimate.covariance = {CovarianceKind::prior, names, 1e-6 * Eigen::MatrixXd::Identity(n, n)};
  estimate.calibration = CalibrationSummary{.pixel_sigma_px = 0.2, .rms_px = 0.2};
  estimate.evidence = {board.observations, state.frames, state.T_first_board};
  return compare_models(estimate, options);
}

TEST(ModelComparison, WhatIsHeldOrKnownNeedNotBeDetermined) {
  EXPECT_EQ(compared_by_left_images(true).richer.size(), 2u);
  EXPECT_EQ(compared_by_left_images(false).richer.size(), 2u);
}

}  // namespace
}  // namespace vernier
