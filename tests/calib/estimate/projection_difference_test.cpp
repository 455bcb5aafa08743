// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/projection_difference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"
#include "tests/support/wide_views.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(ProjectionDifference, IsNothingForTheSameRig) {
  const ProjectionDifference d = projection_difference(test::stereo_rig(), test::stereo_rig());
  EXPECT_LT(d.before.max_px, 1e-9);
  EXPECT_LT(d.after.max_px, 1e-9);
  EXPECT_EQ(d.maps.size(), 8u);  // two cameras, four distances
  EXPECT_EQ(d.left_out, 0);
  EXPECT_FALSE(d.expected_rms_px);
}

// The frame of a rig is no property that anybody can see.
TEST(ProjectionDifference, TakesOutADifferenceOfFrames) {
  const Rig a = test::stereo_rig(OpenCv4{});
  const Pose T_b_a{rotation_from_vector({0.05, -0.03, 0.02}), {0.04, -0.1, 0.03}};
  Rig b = a;
  for (Pose& T : b.T_camera_first) T = T * T_b_a.inverse();
  const ProjectionDifference d = projection_difference(a, b);
  EXPECT_GT(d.before.rms_px, 10);
  EXPECT_LT(d.after.max_px, 1e-6);
  EXPECT_LT((d.T_b_a.R - T_b_a.R).norm(), 1e-8);
  EXPECT_LT((d.T_b_a.t - T_b_a.t).norm(), 1e-8);
}

TEST(ProjectionDifference, IsTheShiftItselfBeforeAlignment) {
  const Rig a = test::stereo_rig(Pinhole{});
  Rig b = a;
  for (Camera& camera : b.cameras) camera.parameters[2] += 2;
  const ProjectionDifference d = projection_difference(a, b);
  for (const DifferenceMap& map : d.maps) {
    for (const Eigen::Vector2d& e : map.before_px) {
      EXPECT_NEAR(e.x(), 2, 1e-9);
      EXPECT_NEAR(e.y(), 0, 1e-9);
    }
  }
  // nearly a turn of the rig about y by 2 / f
  EXPECT_LT(d.in_focus.rms_px, 0.2);
  EXPECT_NEAR(vector_from_rotation(d.T_b_a.R).y(), -2.0 / 526, 0.1 * 2 / 526);
}

TEST(ProjectionDifference, KeepsWhatNoMotionOfTheRigExplains) {
  const Rig a = test::stereo_rig();
  Rig b = a;
  b.cameras[1].parameters[3] += 1;  // vertical disparity
  const ProjectionDifference d = projection_difference(a, b, {.focus_share = 1});
  EXPECT_GT(d.after.rms_px, 0.45);  // half of it in each camera
  EXPECT_LT(d.after.rms_px, d.before.rms_px);
}

TEST(ProjectionDifference, LeavesTranslationAloneWhereAllIsFar) {
  const Rig a = test::stereo_rig();
  Rig b = a;
  b.cameras[0].parameters[2] += 1;
  const ProjectionDifference d = projection_difference(a, b, {.distances_m = {infinity}});
  EXPECT_LT(d.T_b_a.t.norm(), 1e-12);
  EXPECT_GT(vector_from_rotation(d.T_b_a.R).norm(), 1e-4);
}

TEST(ProjectionDifference, IsALeastSquaresMinimum) {
  const Rig a = test::stereo_rig();
  Rig b = a;
  b.cameras[1].parameters[0] += 4;
  b.cameras[0].parameters[4] += 0.02;
  const ProjectionDifferenceOptions options{.focus_share = 1};
  const ProjectionDifference d = projection_difference(a, b, options);
  for (int k = 0; k < 6; ++k) {
    for (const double step : {-1e-4, 1e-4}) {
      // b seen from a frame moved away from the minimum
      Rig moved = b;
      const Pose T = retract(d.T_b_a, step * Eigen::Matrix<double, 6, 1>::Unit(k));
      for (Pose& pose : moved.T_camera_first) pose = pose * T;
      EXPECT_GT(projection_difference(a, moved, options).before.rms_px, d.after.rms_px);
    }
  }
}

TEST(ProjectionDifference, LeavesOutPixelsWithoutARay) {
  Rig a = test::stereo_rig();
  a.cameras[0].parameters[4] = -0.9;  // folds well inside the image
  const ProjectionDifference d = projection_difference(a, test::stereo_rig());
  EXPECT_GT(d.left_out, 0);
  EXPECT_TRUE(std::isnan(d.maps[0].after_px[0].x()));
  EXPECT_TRUE(std::isfinite(d.after.max_px));
}

// The alignment turns by 8 px of 300 a radian, and takes rays of the edge behind the camera.
TEST(ProjectionDifference, LeavesOutWhatTheAlignmentTakesBehindAFisheye) {
  const Rig a = test::wide_rig();
  Rig b = a;
  for (Camera& camera : b.cameras) camera.parameters[2] += 8;
  const ProjectionDifference d = projection_difference(a, b, {.grid = {81, 61}});
  EXPECT_NEAR(vector_from_rotation(d.T_b_a.R).y(), -8.0 / 300, 0.2 * 8 / 300);
  EXPECT_GT(d.left_out, projection_difference(a, a, {.grid = {81, 61}}).left_out);
  EXPECT_TRUE(std::isfinite(d.after.max_px));
  EXPECT_LT(d.in_focus.rms_px, 2);
}

TEST(ProjectionDifference, RefusesBadOptions) {
  const Rig rig = test::stereo_rig();
  const auto error_output = [&](const ProjectionDifferenceOptions& options) {
    return test::error_message([&] { projection_difference(rig, rig, options); });
  };
  EXPECT_EQ(error_output({.distances_m = {}}), "distances: none is given; give at least one");
  EXPECT_EQ(error_output({.distances_m = {1, -2}}),
            "distances: one is not above 0; give metres, or inf");
  EXPECT_EQ(error_output({.grid = {0, 5}}),
            "grid: it has no pixels; give at least one column and one row");
  EXPECT_NE(error_output({.focus_share = 0}).find("focus"), std::string::npos);
  EXPECT_NE(error_output({.distances_m = {1}, .grid = {1, 1}}).find("fewer than 6 pixels"),
            std::string::npos);
  // one pixel a camera in the focus, at four distances
  for (const int side : {1, 3}) {
    const std::string message =
        error_output({.distances_m = {1, 2, 5, 10}, .grid = {side, side}, .focus_share = 0.5});
    EXPECT_NE(message.find("fewer than 6 pixels"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace vernier
