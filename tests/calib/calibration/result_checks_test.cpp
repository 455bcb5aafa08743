// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/result_checks.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// The left camera as calibrated from five of OpenCV's pairs, whose boards leave the corners empty.
Rig folded_rig() {
  Rig rig = test::stereo_rig(OpenCv5{});
  rig.cameras[0].parameters << 534.75583, 0.9993611, 338.2308, 236.27274, -0.29390355, 0.14699124,
      0.0016356615, -0.00040864219, -0.13166338;
  return rig;
}

TEST(NoiseWarning, HasTwoTailsAndDoesNotDependOnTheNumberOfCorners) {
  for (const double dof : {100.0, 1e4, 1e6}) {
    EXPECT_TRUE(noise_warning(9.1 * dof, dof, 0.2)) << dof;
    EXPECT_FALSE(noise_warning(8.9 * dof, dof, 0.2)) << dof;
    EXPECT_FALSE(noise_warning(dof / 8.9, dof, 0.2)) << dof;
    EXPECT_TRUE(noise_warning(dof / 9.1, dof, 0.2)) << dof;
  }
  EXPECT_FALSE(noise_warning(0.5, 5, 0.2));  // by chance, once in 130 times
  EXPECT_TRUE(noise_warning(8.6e19, 2714, 1e-9));
  EXPECT_FALSE(noise_warning(1e-20, 2714, 0.2));  // computed corners have no noise to doubt
  EXPECT_TRUE(noise_warning(2714 * 1e-4, 2714, 0.2));
}

TEST(PriorConflictWarning, NamesWhatIsHeldFarFromThePrior) {
  const Rig rig = test::stereo_rig(OpenCv5{});
  const auto places = static_cast<Eigen::Index>(parameter_names(rig).size());
  const Eigen::MatrixXd all_held = Eigen::MatrixXd::Zero(places, places);
  const double tx_m = rig.T_camera_first[1].t.x();
  const auto said = [&](double away_m) {
    const RigPrior prior = rig_prior(rig, {{"right.tx_m", tx_m + away_m, 0.001}});
    return prior_conflict_warning(prior, rig, all_held, all_held, 20).value_or("");
  };
  EXPECT_EQ(said(0.0038), "");  // p = 1.4e-4
  EXPECT_EQ(said(0.01).find("what is held and the prior disagree: right.tx_m is held 10.0"), 0u)
      << said(0.01);
}

// Of a correlated prior: what is held moves what it says of the rest.
TEST(PriorConflictWarning, ExpectsTheRestWhereWhatIsHeldPutsIt) {
  const Rig mean = test::stereo_rig(OpenCv5{});
  const std::vector<std::string> names = parameter_names(mean);
  const auto places = static_cast<Eigen::Index>(names.size());
  const auto f = std::find(names.begin(), names.end(), "left.f_px") - names.begin();
  const auto k1 = std::find(names.begin(), names.end(), "left.k1") - names.begin();
  RigPrior prior = rig_prior(
      mean, {{"left.f_px", mean.cameras[0].f_px(), 1}, {"left.k1", parameters(mean)[k1], 0.01}});
  prior.information(f, k1) = prior.information(k1, f) = 0.99 * 100;  // correlated by -0.99
  Rig rig = mean;
  rig.cameras[0].parameters[0] += 5;  // held, 0.7 of its standard deviations
  rig.cameras[0].parameters[core_parameter_count] -= 5 * 0.99 * 0.01;
  Eigen::MatrixXd small = Eigen::MatrixXd::Zero(places, places);
  small(k1, k1) = 1e-10;
  EXPECT_EQ(prior_conflict_warning(prior, rig, small, small, 20).value_or(""), "");
  rig.cameras[0].parameters[core_parameter_count] += 5 * 0.99 * 0.01;
  EXPECT_NE(prior_conflict_warning(prior, rig, small, small, 20).value_or("").find("left.k1 moved"),
            std::string::npos);
}

TEST(InversionWarnings, NameTheCameraAndTheRegion) {
  const std::vector<std::string> warnings = inversion_warnings(folded_rig());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("the distortion of camera \"left\" cannot be inverted in 1."), 0u)
      << warnings[0];
  EXPECT_NE(warnings[0].find("(top left, bottom left; from 38"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("use a model with fewer distortion parameters"), std::string::npos);
}

// The share was "1e+02 %" from 99.5 % on.
TEST(InversionWarnings, SayTheShareInPlainDigits) {
  const auto said_of = [](double k1) {
    Rig rig = test::stereo_rig(OpenCv5{});
    for (Camera& camera : rig.cameras) camera.parameters.tail<5>().setZero();
    rig.cameras[0].parameters[core_parameter_count] = k1;
    return inversion_warnings(rig).at(0);
  };
  EXPECT_NE(said_of(-1e9).find(" in 100 % of its image"), std::string::npos) << said_of(-1e9);
  EXPECT_NE(said_of(-10).find(" in 96 % of its image"), std::string::npos) << said_of(-10);
  EXPECT_NE(said_of(-0.32).find(" in 4.0 % of its image"), std::string::npos) << said_of(-0.32);
}

TEST(InversionWarnings, LensesThatDoNotFoldPassInSilence) {
  EXPECT_TRUE(inversion_warnings(test::stereo_rig()).empty());
  for (const CameraModel& model : {CameraModel(OpenCv5{}), CameraModel(Fisheye4{})}) {
    Rig rig = test::stereo_rig(model);
    for (Camera& camera : rig.cameras) {
      camera.parameters.tail(camera.parameters.size() - core_parameter_count).setZero();
    }
    EXPECT_TRUE(inversion_warnings(rig).empty());
  }
}

}  // namespace
}  // namespace vernier
