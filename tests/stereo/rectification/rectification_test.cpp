// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification.h"

#include <gtest/gtest.h>

#include <string>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::stereo;

namespace {

TEST(Rectification, BothEyesSeeAPointInOneRow) {
  const Rig rig = test::stereo_rig();
  const Rectification r = rectification(rig);
  EXPECT_LT(
      (r.R_rectified_left * r.R_rectified_left.transpose() - Eigen::Matrix3d::Identity()).norm(),
      1e-14);
  EXPECT_GT(r.R_rectified_left.determinant(), 0);
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0.5, 0.3, 2), Eigen::Vector3d(-1, 0.7, 4)}) {
    const Eigen::Vector3d left = r.R_rectified_left * x;
    const Eigen::Vector3d right = r.R_rectified_right * (rig.T_camera_first[1] * x);
    EXPECT_NEAR(left.y() / left.z(), right.y() / right.z(), 1e-14);
    EXPECT_GT(left.x() / left.z() - right.x() / right.z(), 0);  // disparity positive in front
  }
}

TEST(Rectification, EpipolarAngleOfLinesAlongAndAcrossTheBaseline) {
  const Rig rig = test::stereo_rig();
  const Rectification r = rectification(rig);
  const Eigen::Vector3d baseline = -(rig.T_camera_first[1].R.transpose() * rig.T_camera_first[1].t);
  const auto angle = [&](const Eigen::Vector3d& direction) {
    const Eigen::Vector3d middle(0.2, 0.3, 3);
    const auto pixel = [&](double t) -> Eigen::Vector2d {
      return project(rig.cameras[0], middle + t * direction);
    };
    return epipolar_angle_rad(rig, r, {pixel(-0.2), pixel(0.2)}).value();
  };
  EXPECT_NEAR(angle(baseline.normalized()), 0, 1e-12);
  EXPECT_NEAR(angle({0, 1, 0}), M_PI / 2, 0.05);
}

TEST(Rectification, NoEpipolarAngleBeyondTheField) {
  const Rig rig = test::stereo_rig(Fisheye4{});
  const Rectification r = rectification(rig);
  const Eigen::Vector2d middle = rig.cameras[0].parameters.segment<2>(2);
  EXPECT_TRUE(epipolar_angle_rad(rig, r, {middle, middle + Eigen::Vector2d(9, 9)}));
  EXPECT_FALSE(epipolar_angle_rad(rig, r, {middle, middle + Eigen::Vector2d(1e6, 9)}));
}

TEST(Rectification, NoBaselineIsRefused) {
  Rig rig = test::stereo_rig();
  rig.T_camera_first[1].t.setZero();
  EXPECT_THROW(rectification(rig), Error);
}

TEST(Rectification, PixelsOfACameraThatIsNotThereAreRefused) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry geometry = rectified_geometry(rig);
  const std::string remedy = "; give 0 for the left one or 1 for the right one";
  EXPECT_EQ(test::error_message([&] {
              rectified_pixel(rig, geometry, 3, {1, 2});
            }),
            "rectification: the pair has no camera 3" + remedy);
  EXPECT_EQ(test::error_message([&] {
              raw_pixel(rig, geometry, -1, {1, 2});
            }),
            "rectification: the pair has no camera -1" + remedy);
}

}  // namespace
}  // namespace vernier
