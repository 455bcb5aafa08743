// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "calib/board_detection.h"
#include "calib/calibrate.h"
#include "calib/covariance_choice.h"
#include "calib/projection_difference.h"
#include "calib/rig_difference.h"
#include "tests/support/data_folder.h"

namespace vernier {
namespace {

// No covariance covers the model: on the same 13 real pairs, two models put the right camera's
// centre some ten of the bound's standard deviations apart.
TEST(RealPairs, TwoModelsDifferBeyondTheirBounds) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA names no folder of data";
  const auto folder = (*data / "calib_opencv_case1").string();
  const ImageDetections found =
      detect_images({folder + "/left*.png", folder + "/right*.png"}, {9, 6, 0.025});
  const RigEstimate a = calibrate(found.observations);
  const RigEstimate b = calibrate(found.observations, {.model = OpenCv4{}});
  const RigDifference d = rig_difference(a.rig, *chosen_covariance(a, CovarianceChoice::mvb), b.rig,
                                         *chosen_covariance(b, CovarianceChoice::mvb));
  EXPECT_LT(d.p_value, 1e-10);
  for (const ParameterDifference& p : d.parameters) {
    if (p.name != "right.ox_px") continue;
    RecordProperty("right_centre_in_sigma", std::to_string(p.delta / p.sigma));
    EXPECT_GT(p.delta / p.sigma, 6);  // of C_a + C_b
    const Eigen::Index k = 7;
    EXPECT_NEAR(p.delta / std::sqrt((*a.covariance_mvb)(k, k)), 11, 2);  // of radial1's alone
  }
  EXPECT_EQ(shared_views(*a.evidence, a.rig, *b.evidence, b.rig), 26);

  // Where the boards were, the projections agree within half a pixel all the same.
  const ProjectionDifference projection = projection_difference(a.rig, b.rig);
  EXPECT_LT(projection.in_focus.rms_px, 0.5);
  EXPECT_GT(projection.after.max_px, 20);  // in the corners of the images, where none was
}

}  // namespace
}  // namespace vernier
