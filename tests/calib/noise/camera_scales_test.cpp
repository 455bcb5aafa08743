// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/camera_scales.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/noise/component_tests.h"
#include "calib/noise/corner_noise.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/noise_of_estimate.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/random.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// Two views of a corner each: of residuals (3, 4), and of (0, 5 × `factor`).
std::vector<FrameRows> two_cameras(double factor) {
  FrameRows rows;
  rows.views = {{0, {0}, 0}, {1, {0}, 2}};
  rows.residual_px = Eigen::Vector4d(3, 4, 0, 5 * factor);
  rows.by_rig = Eigen::MatrixXd::Ones(4, 3);
  rows.by_pose.setOnes(4, 6);
  rows.by_motion = Eigen::MatrixXd::Ones(4, 6);
  rows.by_point.setOnes(4, 3);
  return {rows};
}

TEST(CameraScales, AreTheResidualsOverThePooledOnes) {
  const Eigen::VectorXd scales = camera_scales(two_cameras(3));
  EXPECT_NEAR(scales[1] / scales[0], 3, 1e-12);
  EXPECT_NEAR(scales.squaredNorm(), 2, 1e-12);
  EXPECT_TRUE((camera_scales(two_cameras(1.2)).array() == 1).all());
  EXPECT_EQ(camera_scales(two_cameras(0))[1], 1) << "without residuals";
  std::vector<FrameRows> rows = two_cameras(3);
  divide_by_camera(scales, rows);
  EXPECT_NEAR(rows[0].residual_px.head<2>().norm(), rows[0].residual_px.tail<2>().norm(), 1e-12);
  EXPECT_NEAR(rows[0].by_point(1, 0) / rows[0].by_point(2, 0), 3, 1e-12);
  EXPECT_NEAR(rows[0].by_rig(0, 2), 1 / scales[0], 1e-12);
}

/// A pair whose right camera has twice the focal length, and four times the noise.
RigEstimate of_unlike_cameras(double shape_m, std::uint32_t set) {
  Rig truth = test::stereo_rig();
  Camera& right = truth.cameras[1];
  for (const int k : {0, 2, 3}) right.parameters[k] *= 2;
  right.size_px *= 2;
  const CornerNoise noise{
      .white_px = 0.15, .shape_plane_m = shape_m / 3, .shape_height_m = shape_m};
  auto seen = test::noisy_board(truth, {7, 5, 0.04},
                                {.seed = 2203, .trial = set, .poses = set, .frames = 10}, noise);
  RandomStream draws({.seed = 2203, .trial = set, .source = 253});
  for (BoardView& view : seen.board.observations.views) {
    if (view.camera == 0) continue;
    for (auto& pixel : view.pixels_px) {
      pixel.x() += 0.58 * draws.normal();
      pixel.y() += 0.58 * draws.normal();
    }
  }
  return calibrate(seen.board.observations, {.check_input = false});
}

TestedNoise tested(const RigEstimate& estimate, CameraNoise cameras) {
  return estimate_corner_noise(estimate, {.shape = true}, {.field = false, .shape = true}, cameras);
}

// A flat board is called uneven in 1 % of sets: two of six or more, once in 700 changes of the
// seed. With the noise of one camera for all most of these were.
TEST(CameraScales, FlatBoardsOfUnlikeCamerasStayFlat) {
  int found = 0, found_alike = 0;
  for (std::uint32_t set = 0; set < 6; ++set) {
    const RigEstimate estimate = of_unlike_cameras(0, set);
    found += tested(estimate, CameraNoise::of_each).shape->p_value < 0.01;
    found_alike += tested(estimate, CameraNoise::alike).shape->p_value < 0.01;
  }
  EXPECT_LE(found, 1);
  EXPECT_GE(found_alike, 3);
}

TEST(CameraScales, UnevenBoardsOfUnlikeCamerasAreFound) {
  for (std::uint32_t set = 0; set < 3; ++set) {
    EXPECT_LT(tested(of_unlike_cameras(4e-4, set), CameraNoise::of_each).shape->p_value, 1e-3);
  }
}

}  // namespace
}  // namespace vernier
