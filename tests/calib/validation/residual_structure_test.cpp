// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/residual_structure.h"

#include <gtest/gtest.h>

#include <numeric>

#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

TEST(ResidualStructure, EveryCornerFallsIntoItsCell) {
  const std::vector<CornerResidual> residuals{
      {0, 0, {-0.5, -0.5}, {0.1, 0}},  // the image's corners, to the half pixel
      {0, 1, {639.5, 479.5}, {0, -0.3}},
      {0, 2, {319.4, 100}, {0.2, 0.2}},  // just left of the middle
      {0, 3, {319.6, 100}, {-9, 9}},     // just right of it, and off the histogram
  };
  const ResidualStructure s = residual_structure(residuals, {640, 480}, 0.1, 4, 3);
  ASSERT_EQ(s.cells.size(), 12u);
  for (const auto& [cell, corners] : {std::pair{0, 1}, {11, 1}, {1, 1}, {2, 1}, {5, 0}}) {
    EXPECT_EQ(s.cells[cell].corners, corners) << cell;
  }
  EXPECT_EQ(s.filled, 4);
  EXPECT_EQ(s.beyond_95, 3);  // 1, 3, 2.8 and 127 standard deviations
  EXPECT_EQ(std::accumulate(s.histogram.begin(), s.histogram.end(), 0), 8);
  EXPECT_EQ(s.histogram.front(), 1);
  EXPECT_EQ(s.histogram.back(), 1);
  EXPECT_DOUBLE_EQ(s.beyond_3_sigma, 2.0 / 8);
}

TEST(ResidualStructure, CommonResidualGrowsWithTheRootOfTheCount) {
  std::vector<CornerResidual> residuals(25, {0, 0, {10, 10}, {0.03, 0.04}});
  const ResidualStructure s = residual_structure(residuals, {640, 480}, 0.1, 8, 6);
  EXPECT_NEAR((s.cells[0].mean_px - Eigen::Vector2d(0.03, 0.04)).norm(), 0, 1e-15);
  EXPECT_NEAR(s.cells[0].in_sigmas, 0.5 * 5, 1e-12);
}

/// Cells beyond the 95 % limit of a calibration with `fitted` of what `truth` sees.
double share_beyond(const Rig& truth, const CameraModel& fitted) {
  const auto board = simulate_board(truth, {}, {.seed = 61, .frames = 30, .pixel_sigma_px = 0.05});
  const RigEstimate e = calibrate(board.observations, {.model = fitted, .reject_outliers = false});
  const auto residuals = residuals_of_camera(e, 0);
  EXPECT_EQ(residuals.size(), 30u * 54);
  const ResidualStructure s =
      residual_structure(residuals, {640, 480}, e.calibration->pixel_sigma_px, 12, 9);
  EXPECT_GT(s.filled, 60);
  return static_cast<double>(s.beyond_95) / s.filled;
}

// 5 % of about 90 cells: 0.17 is beyond five binomial standard deviations.
TEST(ResidualStructure, RightModelLeavesNoiseAndAWrongOneStructure) {
  Rig truth = test::stereo_rig(OpenCv4{});
  for (Camera& camera : truth.cameras) camera.parameters[6] = 4e-3;  // p1
  EXPECT_LT(share_beyond(truth, OpenCv4{}), 0.17);
  EXPECT_GT(share_beyond(truth, Radial1{}), 0.4);
}

TEST(ResidualStructure, SaysWhatIsMissing) {
  EXPECT_NE(test::error_message([] {
              residual_structure({}, {640, 480}, 0, 4, 3);
            }).find("no pixel noise"),
            std::string::npos);
  EXPECT_NE(test::error_message([] { residuals_of_camera({}, 0); }).find("holds no evidence"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
