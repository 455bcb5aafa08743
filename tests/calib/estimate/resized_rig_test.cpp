// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/resized_rig.h"

#include <gtest/gtest.h>

#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "tests/support/calibrations_covariance.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

TEST(ResizedRig, ShowsPointsWhereTheEnlargedPictureHasThem) {
  RigEstimate estimate;
  estimate.rig = test::stereo_rig();
  const RigEstimate larger = resized(estimate, {960, 800});
  for (std::size_t c = 0; c < 2; ++c) {
    for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.3, -0.2, 1.5), {-0.4, 0.3, 2}}) {
      const Eigen::Vector2d before = project(estimate.rig.cameras[c], point);
      const Eigen::Vector2d after = project(larger.rig.cameras[c], point);
      // Pixel edges, not centres, scale: the left border is at -1/2.
      EXPECT_NEAR(after.x() + 0.5, 1.5 * (before.x() + 0.5), 1e-9);
      EXPECT_NEAR(after.y() - 399.5, 1.5 * (before.y() - 239.5), 1e-9);
    }
  }
}

TEST(ResizedRig, DeviationsInPixelsScaleAndBackAgain) {
  RigEstimate estimate;
  estimate.rig = test::stereo_rig();
  estimate.covariance = test::calibrations_covariance(estimate.rig);
  const RigEstimate half = resized(estimate, {320, 240});
  const Eigen::MatrixXd &C = estimate.covariance->matrix, &D = half.covariance->matrix;
  const auto names = parameter_names(estimate.rig);
  const auto factor = [&](Eigen::Index i) {
    return names[static_cast<std::size_t>(i)].find("_px") != std::string::npos ? 0.5 : 1.0;
  };
  for (Eigen::Index i = 0; i < C.rows(); ++i) {
    for (Eigen::Index j = 0; j < C.cols(); ++j) {
      EXPECT_NEAR(D(i, j), factor(i) * factor(j) * C(i, j), 1e-15);
    }
  }
  const RigEstimate back = resized(half, {640, 480});
  EXPECT_TRUE(back.covariance->matrix.isApprox(C, 1e-12));
  EXPECT_LT((parameters(back.rig) - parameters(estimate.rig)).norm(), 1e-9);
}

TEST(ResizedRig, RefusesNoSize) {
  EXPECT_NE(test::error_message([] {
              RigEstimate estimate;
              estimate.rig = test::stereo_rig();
              resized(estimate, {0, 480});
            }).find("0x480"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
