// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/rig.h"

#include <gtest/gtest.h>

#include <string>

#include "calib/lens_models.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

TEST(Rig, NamesAreTheContract) {
  const std::vector<std::string> expected{
      "left.f_px",    "left.ax",     "left.ox_px",  "left.oy_px", "left.k1",      "right.f_px",
      "right.ax",     "right.ox_px", "right.oy_px", "right.k1",   "right.wx_rad", "right.wy_rad",
      "right.wz_rad", "right.tx_m",  "right.ty_m",  "right.tz_m"};
  EXPECT_EQ(parameter_names(test::stereo_rig()), expected);
}

TEST(Rig, DifferenceInvertsRetract) {
  const Rig rig = test::stereo_rig(OpenCv5{});
  const Eigen::VectorXd delta = Eigen::VectorXd::LinSpaced(parameter_count(rig), -0.05, 0.08);
  EXPECT_LT((difference(retract(rig, delta), rig) - delta).norm(), 1e-12);
}

TEST(Rig, RetractRefusesAChangeOfAnotherSize) {
  const Rig rig = test::stereo_rig();
  for (const int size : {0, 15, 17}) {
    EXPECT_EQ(test::error_message([&] { retract(rig, Eigen::VectorXd::Zero(size)); }),
              "rig: " + std::to_string(size) +
                  " changes for 16 parameters; give one a parameter, in the order of "
                  "parameter_names");
  }
}

TEST(Rig, IndicesOfCamerasThatAreNotThereAreRefused) {
  const Rig rig = test::stereo_rig();
  EXPECT_EQ(pose_index(rig, 1), 10);
  EXPECT_EQ(test::error_message([&] { pose_index(rig, 0); }),
            "rig: no such camera: 0 of 2; count from 0; the first camera has no pose");
  EXPECT_EQ(test::error_message([&] { intrinsics_index(rig, 9); }),
            "rig: no such camera: 9 of 2; count from 0");
  EXPECT_NE(test::error_message([&] { intrinsics_index(rig, -1); }), "");
}

TEST(Rig, AMissingPoseIsRefused) {
  Rig rig = test::stereo_rig();
  rig.T_camera_first.pop_back();
  const std::string text = "rig: 1 poses for 2 cameras; give one a camera, the first the identity";
  EXPECT_EQ(test::error_message([&] { parameters(rig); }), text);
  EXPECT_EQ(test::error_message([&] { retract(rig, Eigen::VectorXd::Zero(16)); }), text);
  EXPECT_EQ(test::error_message([&] { difference(rig, test::stereo_rig()); }), text);
}

TEST(Rig, NoDifferenceOfRigsOfOtherCameras) {
  const Rig rig = test::stereo_rig();
  Rig fewer = rig;
  fewer.cameras.pop_back();
  fewer.T_camera_first.pop_back();
  const std::string text =
      "rig: the rigs differ in their number of cameras, or in a lens model; give two rigs of the "
      "same cameras and models";
  EXPECT_EQ(test::error_message([&] { difference(rig, fewer); }), text);
  EXPECT_EQ(test::error_message([&] { difference(test::stereo_rig(Pinhole{}), rig); }), text);
}

}  // namespace
}  // namespace vernier
