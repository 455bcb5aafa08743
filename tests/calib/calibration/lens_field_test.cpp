// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/lens_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/result_checks.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_prior.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/reprojection_problem.h"
#include "tests/support/rig_distance.h"
#include "tests/support/wide_views.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using test::corners_of;
using test::wide_rig;
using test::wide_views;

/// Whether the list has this text at its place `i`.
testing::AssertionResult says(const std::vector<std::string>& list,
                              std::size_t i,
                              const std::string& text) {
  if (list.size() <= i) return testing::AssertionFailure() << "only " << list.size() << " entries";
  if (list[i].find(text) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << list[i];
}

// One corner in a hundred beyond 90 degrees spoiled every view it was in. Worst of 22 parameters
// beyond 5 standard deviations: 1e-5.
TEST(LensField, CornersBeyondItAreLeftOutAndTheRestDecides) {
  const Rig rig = wide_rig();
  for (const double most_deg : {91.0, 93.0, 98.0}) {
    const auto [seen, beyond] = wide_views(rig, {.most_deg = most_deg});
    ASSERT_GT(beyond, 5);
    const RigEstimate estimate = calibrate(seen, {.model = Fisheye4{}});
    const CalibrationSummary& summary = *estimate.calibration;
    EXPECT_TRUE(summary.trust_warnings.empty()) << summary.trust_warnings[0];
    EXPECT_TRUE(summary.outliers.empty()) << summary.outliers.size();
    EXPECT_NEAR(summary.pixel_sigma_px, 0.2, 0.01);
    EXPECT_LT(test::worst_sigmas(estimate.rig, rig, estimate.covariance->matrix), 5);
    const std::size_t kept = corners_of(estimate.evidence->observations);
    EXPECT_LE(kept, corners_of(seen) - static_cast<std::size_t>(beyond));
    EXPECT_GE(kept, corners_of(seen) - static_cast<std::size_t>(2 * beyond));
    EXPECT_TRUE(says(summary.warnings, 0,
                     "lie 89.5 degrees from its axis or beyond, where fisheye4 has no rays"));
  }
}

TEST(LensField, IsFoundWithTheSameHeldAsTheCalibrationThatFollows) {
  const Rig rig = wide_rig();
  BoardObservations seen = wide_views(rig, {.most_deg = 93}).observations;
  const std::size_t before = corners_of(seen);
  const std::vector<HeldParameter> held{{"left.k4", -0.0008}, {"right.ax", 1.0}};
  BoardState state = initial_state(seen, {Fisheye4{}, Fisheye4{}});
  ReprojectionProblem problem;
  problem.held = held_mask(state.rig, held);
  std::vector<std::string> warnings;
  leave_out_beyond_field(seen, state, held, problem, warnings);
  EXPECT_LT(corners_of(seen), before);
  EXPECT_EQ(state.rig.cameras[0].parameters[7], -0.0008);
  EXPECT_EQ(state.rig.cameras[1].ax(), 1);
  EXPECT_NE(state.rig.cameras[0].ax(), 1);
}

TEST(LensField, TakesNothingFromWhatIsWithin) {
  const Rig rig = wide_rig();
  const BoardObservations seen = wide_views(rig, {.most_deg = 89.3, .seed = 8}).observations;
  const RigEstimate estimate = calibrate(seen, {.model = Fisheye4{}});
  EXPECT_EQ(corners_of(estimate.evidence->observations), corners_of(seen));
  EXPECT_TRUE(estimate.calibration->outliers.empty());
  EXPECT_LT(test::worst_sigmas(estimate.rig, rig, estimate.covariance->matrix), 5);
}

// All their corners are set aside at 80 degrees, so that nothing else places these boards.
TEST(LensField, FramesAtItsEdgeStay) {
  const Rig rig = wide_rig();
  const BoardObservations seen =
      wide_views(rig, {.most_deg = 89.3, .square_m = 0.02, .edge_frames = 10}).observations;
  ASSERT_EQ(frames_of(seen).size(), 40u);
  const RigEstimate estimate = calibrate(seen, {.model = Fisheye4{}});
  EXPECT_EQ(corners_of(estimate.evidence->observations), corners_of(seen));
  EXPECT_LT(test::worst_sigmas(estimate.rig, rig, estimate.covariance->matrix), 5);
}

// Of a board all but two corners are beyond: these two go too, and are not said to be beyond.
TEST(LensField, GoodCornersLostWithTheirImageAreCountedApart) {
  const Rig rig = wide_rig();
  BoardObservations seen = wide_views(rig, {.most_deg = 98, .from_axis_deg = 75}).observations;
  const std::size_t all = corners_of(seen);
  const RigEstimate whole = calibrate(seen, {.model = Fisheye4{}});
  const BoardObservations& left = whole.evidence->observations;
  // The view that loses most keeps two of its good corners, and all that are beyond.
  BoardView* most = nullptr;
  std::vector<int> good;
  std::size_t most_lost = 0;
  for (BoardView& view : seen.views) {
    std::vector<int> kept;
    for (const BoardView& own : left.views) {
      if (own.frame == view.frame && own.camera == view.camera) kept = own.ids;
    }
    if (kept.empty() || view.ids.size() - kept.size() <= most_lost) continue;
    most_lost = view.ids.size() - kept.size();
    most = &view;
    good = kept;
  }
  ASSERT_GE(most_lost, 4u);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < most->ids.size();) {
    const auto at = std::find(good.begin(), good.end(), most->ids[i]);
    if (at == good.end() || at - good.begin() < 2) {
      ++i;
      continue;
    }
    most->ids.erase(most->ids.begin() + static_cast<long>(i));
    most->pixels_px.erase(most->pixels_px.begin() + static_cast<long>(i));
    ++taken;
  }
  const int camera = most->camera;
  ASSERT_EQ(corners_of(seen), all - taken);
  const RigEstimate fewer = calibrate(seen, {.model = Fisheye4{}});
  EXPECT_EQ(corners_of(fewer.evidence->observations) + 2 + taken, corners_of(left));
  EXPECT_TRUE(says(fewer.calibration->warnings, static_cast<std::size_t>(camera),
                   ": left out, with them 2 within, of images that show too little else"));
}

TEST(LensField, ThatNoMinimumTellsWhichCornersAreBeyondIsSaid) {
  const Rig rig = wide_rig();
  BoardObservations seen =
      wide_views(rig, {.most_deg = 89.3, .square_m = 0.02, .frames = 2, .edge_frames = 12})
          .observations;
  const auto warnings = [&]() -> std::vector<std::string> {
    try {
      return calibrate(seen, {.model = Fisheye4{}}).calibration->warnings;
    } catch (const Error& error) {
      return {error.what()};
    }
  }();
  const auto said = std::count_if(warnings.begin(), warnings.end(), [](const std::string& text) {
    return text.find("may lie beyond the field of fisheye4 and were kept") != std::string::npos;
  });
  EXPECT_EQ(said, 2) << warnings[0];
}

TEST(LensField, IsToldApartFromAFold) {
  Rig rig = wide_rig();
  EXPECT_TRUE(is_beyond(rig.cameras[0], {1200, 478}, fisheye_field_rad));
  EXPECT_FALSE(is_beyond(rig.cameras[0], {1000, 478}, fisheye_field_rad));
  const std::vector<std::string> warnings = inversion_warnings(rig);
  ASSERT_EQ(warnings.size(), 2u);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_TRUE(says(warnings, i, "sees 89.5 degrees from its axis and beyond in 4"));
    EXPECT_TRUE(says(warnings, i, "crop or mask these pixels"));
  }
  rig.cameras[0].parameters.tail<4>() << -0.3, 0, 0, 0;  // rises up to 60 degrees
  EXPECT_FALSE(is_beyond(rig.cameras[0], {1200, 478}, fisheye_field_rad));
  EXPECT_NE(inversion_warnings(rig).at(0).find("cannot be inverted in"), std::string::npos);
  rig.cameras[0].model = OpenCv4{};
  EXPECT_FALSE(is_beyond(rig.cameras[0], {1200, 478}, fisheye_field_rad));
}

}  // namespace
}  // namespace vernier
