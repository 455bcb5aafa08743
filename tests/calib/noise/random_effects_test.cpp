// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/random_effects.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

// Without effects in the corners, the components of shape and motion are near zero and the rig
// stays where it is.
TEST(RandomEffects, LeaveARigWithoutThemWhereItIs) {
  const auto drawn =
      test::noisy_board(test::stereo_rig(), {}, {.seed = 821, .frames = 14}, {.white_px = 0.15});
  const RigEstimate usual = calibrate(drawn.board.observations, {.check_input = false});
  const RigEstimate with = calibrate(drawn.board.observations,
                                     {.check_input = false, .board_shape = true, .motion = true});
  const Eigen::VectorXd sd = usual.covariance->matrix.diagonal().cwiseSqrt();
  EXPECT_LT(difference(with.rig, usual.rig).cwiseQuotient(sd).norm() / 4, 0.35);
  EXPECT_LT(with.calibration->effects->motion_m, 2e-4);
  EXPECT_LT(with.calibration->effects->shape_height_m, 1e-4);
  EXPECT_EQ(with.calibration->pixel_sigma_px, usual.calibration->pixel_sigma_px);
  EXPECT_FALSE(usual.calibration->effects);
}

// The heights found are the true ones but for a plane, which the poses take.
TEST(RandomEffects, FindTheShapeOfTheBoard) {
  const CornerNoise noise{.white_px = 0.05, .motion_m = 2e-4, .shape_height_m = 4e-4};
  const auto drawn = test::noisy_board(test::stereo_rig(), {}, {.seed = 822, .frames = 14}, noise);
  const RigEstimate with = calibrate(
      drawn.board.observations,
      {.reject_outliers = false, .check_input = false, .board_shape = true, .motion = true});
  const auto& found = with.calibration->effects->shape_m;
  const auto& points = drawn.board.observations.target_m;
  ASSERT_EQ(found.size(), points.size());
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd plane(n, 3);
  Eigen::VectorXd error(n), truth(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    plane.row(i) << points[at].x(), points[at].y(), 0.1;
    truth[i] = drawn.shape_m[at].z();
    error[i] = found[at].z() - truth[i];
  }
  const auto without_plane = [&](const Eigen::VectorXd& z) -> Eigen::VectorXd {
    return z - plane * (plane.transpose() * plane).ldlt().solve(plane.transpose() * z);
  };
  EXPECT_LT(without_plane(error).norm(), 0.35 * without_plane(truth).norm());
}

TEST(RandomEffects, RefuseWhatHasNoPlaceBesideThem) {
  const auto pair =
      test::noisy_board(test::stereo_rig(), {}, {.seed = 823, .frames = 6}, {.white_px = 0.1});
  const auto refused = [&](const BoardObservations& views, CalibrationOptions how,
                           const char* what) {
    try {
      calibrate(views, how);
      ADD_FAILURE() << what;
    } catch (const Error& error) {
      EXPECT_EQ(error.place(), what);
    }
  };
  refused(pair.board.observations, {.warp = BoardWarp::free, .board_shape = true}, "--warp");
  refused(pair.board.observations, {.pixel_sigma_px = 0.1, .motion = true}, "--pixel-sigma");
  Rig one = test::stereo_rig();
  one.cameras.resize(1);
  one.T_camera_first.resize(1);
  const auto single = test::noisy_board(one, {}, {.seed = 823, .frames = 6}, {.white_px = 0.1});
  refused(single.board.observations, {.motion = true}, "--motion");
}

}  // namespace
}  // namespace vernier
