// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/vertical_disparity.h"

#include <gtest/gtest.h>

#include <limits>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/triangulation.h"
#include "tests/support/calibrations_covariance.h"
#include "tests/support/chi_squared.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::stereo::internal;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(VerticalDisparity, IsNoneForTheRigThatMadeThePixels) {
  const Rig rig = test::stereo_rig();
  for (const double distance_m : {1.0, 4.0, infinity}) {
    const auto pair = pair_at_distance(rig, {300, 100}, distance_m);
    EXPECT_NEAR(*vertical_disparity_px(rig, *pair, 525), 0, 1e-9);
  }
}

TEST(VerticalDisparity, DerivativeIsThatOfDifferences) {
  for (const char* model : {"pinhole", "radial1", "opencv5", "opencv8", "fisheye4"}) {
    const Rig rig = test::stereo_rig(camera_model(model));
    for (const auto& q : {Eigen::Vector2d(320, 240), {200, 40}, {560, 430}}) {
      const PixelPair pair = pair_at_distance(rig, q, 2).value();
      const auto numeric = test::numeric_jacobian(
          [&](const Eigen::VectorXd& d) {
            return Eigen::VectorXd::Constant(1, *vertical_disparity_px(retract(rig, d), pair, 525));
          },
          Eigen::VectorXd::Zero(parameter_count(rig)), 1e-5);
      const Eigen::RowVectorXd ours = *vertical_disparity_by_rig(rig, pair, 525);
      EXPECT_LT((ours - numeric).cwiseAbs().maxCoeff(), 1e-7 * numeric.cwiseAbs().maxCoeff())
          << model;
    }
  }
}

TEST(VerticalDisparity, OfACentreThatMovesDownIsThatMuchEverywhere) {
  const Rig rig = test::stereo_rig(Pinhole{});
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(14, 14);
  C(7, 7) = 0.25;  // right.oy_px by 0.5 px
  const VerticalDisparityMap map = vertical_disparity_map(rig, C, 12, 9, infinity);
  EXPECT_NEAR(map.mean_sd_px, 0.5, 0.02);
  EXPECT_NEAR(map.rms_px, 0.5, 0.02);
  EXPECT_LT(map.rms_less_mean_px, 0.03);
  EXPECT_LT(map.rms_less_affine_px, map.rms_less_mean_px);
}

TEST(VerticalDisparity, PointsThatTheRightCameraDoesNotSeeAreAbsentAndCounted) {
  const Rig rig = test::stereo_rig();
  const VerticalDisparityMap map =
      vertical_disparity_map(rig, test::calibrations_covariance(rig).matrix, 10, 8, 0.5);
  int nans = 0;
  for (const double sd : map.sd_px) nans += std::isnan(sd);
  EXPECT_EQ(nans, map.absent);
  EXPECT_GT(map.absent, 8);  // f b / d = 210 px of 640 are out of sight
  EXPECT_LT(map.absent, 60);
  EXPECT_GT(map.rms_px, map.rms_less_mean_px);
  EXPECT_GT(map.rms_less_mean_px, map.rms_less_affine_px);
}

// Seed 31 fixed; n − 1 sampled variances over the linear one are chi-squared. False-alarm rate
// 1e-3 over the three pixels.
TEST(VerticalDisparity, SampledIsTheLinearOneAtSmallPsi) {
  RigEstimate estimate;
  estimate.rig = test::stereo_rig();
  estimate.covariance = test::calibrations_covariance(estimate.rig);
  const std::vector<PixelPair> pairs{pair_at_distance(estimate.rig, {320, 240}, 3).value(),
                                     pair_at_distance(estimate.rig, {200, 40}, 3).value(),
                                     pair_at_distance(estimate.rig, {600, 440}, 3).value()};
  const int n = 2000;
  const auto drawn = sampled_vertical_disparity(RigSampler(estimate), pairs, 525,
                                                {.psi_c = 0.05, .samples = n, .seed = 31});
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Eigen::RowVectorXd J = *vertical_disparity_by_rig(estimate.rig, pairs[k], 525);
    const double linear = 0.05 * 0.05 * (J * estimate.covariance->matrix * J.transpose()).value();
    const double statistic = (n - 1) * drawn[k].sd_px * drawn[k].sd_px / linear;
    EXPECT_GT(statistic, test::chi_squared_quantile(n - 1, 1e-3 / 6));
    EXPECT_LT(statistic, test::chi_squared_quantile(n - 1, 1 - 1e-3 / 6));
    EXPECT_EQ(drawn[k].non_physical_share, 0);
  }
}

TEST(VerticalDisparity, BadInputIsNamed) {
  const Rig rig = test::stereo_rig();
  const Eigen::MatrixXd C = test::calibrations_covariance(rig).matrix;
  const auto error_output = [&](const Rig& r, int columns, double distance_m) {
    try {
      vertical_disparity_map(r, C, columns, 9, distance_m);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Rig one = rig;
  one.cameras.pop_back();
  EXPECT_PRED2(says, error_output(one, 9, 1), "the rig has 1 cameras");
  EXPECT_PRED2(says, error_output(rig, 0, 1), "the grid is 0x9");
  EXPECT_PRED2(says, error_output(rig, 9, 0), "the distance is 0 m");
}

}  // namespace
}  // namespace vernier
