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

}  // namespace
}  // namespace vernier
