// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/sampler.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/uncertainty/physical_rig.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

RigEstimate with_deviation(double sd) {
  RigEstimate estimate;
  estimate.rig = test::stereo_rig();
  estimate.covariance = Covariance{CovarianceKind::prior, parameter_names(estimate.rig),
                                   sd * sd * Eigen::MatrixXd::Identity(16, 16)};
  return estimate;
}

TEST(Sampler, RefusesDeviationsBeyondTheRangeOfNumbers) {
  const RigSampler sampler(with_deviation(1e100), "wide.json");
  EXPECT_EQ(
      test::error_message([&] { sampler.sample(1e300, 1, 0); }),
      "wide.json: at psi_c = 1e+300 its standard deviations exceed the range of numbers; give "
      "a smaller psi_c, or correct the covariance");
  EXPECT_TRUE(parameters(RigSampler(with_deviation(1e3)).sample(1, 1, 0)).allFinite());
}

TEST(PhysicalRig, HasPositiveFocalLengthsAndAspects) {
  Rig rig = test::stereo_rig();
  EXPECT_EQ(unphysical(rig), "");
  rig.cameras[1].parameters[1] = -0.1;
  EXPECT_EQ(unphysical(rig), "right.ax is not positive");
  rig.cameras[0].parameters[0] = 0;
  EXPECT_EQ(unphysical(rig), "left.f_px is not positive");
}

TEST(Sampler, RefusesANegativeScale) {
  const RigSampler sampler(with_deviation(1e-3), "some.json");
  EXPECT_EQ(test::error_message([&] { sampler.sample(-1, 1, 0); }),
            "some.json: psi_c = -1 is not a factor on standard deviations; give 0 or more");
  EXPECT_NE(test::error_message([&] { sampler.sample(std::nan(""), 1, 0); }), "");
}

}  // namespace
}  // namespace vernier
