// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/epipolar_band.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo::internal;

namespace {

Eigen::MatrixXd covariance_of(const Rig& rig) {
  Eigen::VectorXd sigma(parameter_count(rig));
  const int camera = parameter_count(rig.cameras[0].model);
  for (int c = 0; c < 2; ++c) {
    sigma.segment(c * camera, camera).setConstant(0.002);
    sigma.segment<4>(c * camera) << 2, 0.002, 1.5, 1.5;
  }
  sigma.tail<6>() << 2e-3, 1e-3, 2e-3, 1e-3, 1e-3, 2e-3;
  Eigen::MatrixXd C = sigma.cwiseAbs2().asDiagonal();
  C(1, 3) = C(3, 1) = 0.5 * sigma[1] * sigma[3];
  return C;
}

class BandByModel : public testing::TestWithParam<const char*> {};

TEST_P(BandByModel, RunsThroughWhereThePointsAre) {
  const Rig rig = test::stereo_rig(camera_model(GetParam()));
  const EpipolarBand band(rig, Eigen::MatrixXd::Zero(parameter_count(rig), parameter_count(rig)),
                          {.nearest_m = 0.5, .corner_sigma_px = 0.1});
  for (const auto& left_px : std::vector<Eigen::Vector2d>{{320, 240}, {500, 60}, {200, 400}}) {
    const auto curve = band.curve({left_px, Eigen::Matrix2d::Zero()});
    const Eigen::Vector3d ray = unproject(rig.cameras[0], left_px);
    for (const double depth : {0.51, 0.7, 1.3, 4.0, 50.0, 1e6}) {
      const auto seen = pixel_pair(rig, depth * ray);
      ASSERT_TRUE(seen);
      if (!in_image(rig.cameras[1], seen->other_px)) continue;
      const auto d = distance_to_curve(curve, {seen->other_px, Eigen::Matrix2d::Zero()});
      EXPECT_LT(0.1 * std::sqrt(d.mahalanobis2), 0.1) << depth;
      EXPECT_NEAR(d.inverse_depth, 1 / depth, 0.02 / depth + 2e-3);
    }
    const auto nearer = pixel_pair(rig, 0.4 * ray);
    const auto d = distance_to_curve(curve, {nearer->other_px, Eigen::Matrix2d::Zero()});
    EXPECT_EQ(d.dof, 2);
    EXPECT_GT(d.mahalanobis2, 100);
  }
}

/// A corner's true partner is outside the 99.7 % gate for 0.3 % of rigs drawn from the prior: 12 of
/// 4000 expected, more than 32 or fewer than 1 with probability 2e-6 and 6e-6. The mean χ² beside
/// the curve has the standard deviation 0.022; 5 of them (6e-7), and 0.03 for the curvature of the
/// model.
TEST_P(BandByModel, HoldsTheTruthAtTheStatedRateOverRigs) {
  RigEstimate prior;
  prior.rig = test::stereo_rig(camera_model(GetParam()));
  prior.covariance =
      Covariance{CovarianceKind::prior, parameter_names(prior.rig), covariance_of(prior.rig)};
  const EpipolarBand band(prior.rig, prior.covariance->matrix,
                          {.nearest_m = 0.8, .corner_sigma_px = 0});
  const RigSampler sampler(prior);
  Eigen::Matrix2d left_noise, right_noise;
  left_noise << 0.04, 0.01, 0.01, 0.09;
  right_noise << 0.09, -0.02, -0.02, 0.04;
  const Eigen::Matrix2d left_root = left_noise.llt().matrixL(),
                        right_root = right_noise.llt().matrixL();
  int n = 0, outside = 0, beside = 0;
  double chi2 = 0;
  for (std::uint32_t trial = 0; n < 4000; ++trial) {
    const Rig truth = sampler.sample(1, 5, trial);
    RandomStream draws({.seed = 5, .trial = trial, .source = 201});
    const Eigen::Vector2d pixel{draws.uniform(40, 600), draws.uniform(40, 440)};
    const double depth = 1 / draws.uniform(1 / 20.0, 1.0);
    const auto seen = pixel_pair(truth, depth * unproject(prior.rig.cameras[0], pixel));
    if (!seen || !in_image(truth.cameras[1], seen->other_px)) continue;
    ++n;
    const Eigen::Vector2d left = seen->first_px + left_root * draws.normals(2);
    const Eigen::Vector2d right = seen->other_px + right_root * draws.normals(2);
    const auto d = distance_to_curve(band.curve({left, left_noise}), {right, right_noise});
    outside += d.mahalanobis2 > chi_squared_quantile(0.997, d.dof);
    beside += d.dof == 1;
    if (d.dof == 1) chi2 += d.mahalanobis2;
  }
  RecordProperty("outside_of_4000", outside);
  RecordProperty("mean_chi2", std::to_string(chi2 / beside));
  EXPECT_GT(beside, 3500);
  EXPECT_NEAR(chi2 / beside, 1, 5 * std::sqrt(2.0 / beside) + 0.03);
  EXPECT_LE(outside, 32);
  EXPECT_GE(outside, 1);
}

INSTANTIATE_TEST_SUITE_P(Models,
                         BandByModel,
                         testing::Values("pinhole", "radial1", "opencv5", "fisheye4"));

TEST(EpipolarBand, GrowsWithTheCovarianceAndNotOtherwise) {
  const Rig rig = test::stereo_rig();
  const Eigen::MatrixXd C = covariance_of(rig);
  const UncertainPixel left{{300, 200}, Eigen::Matrix2d::Zero()};
  const BandOptions options{.corner_sigma_px = 0};
  const auto narrow = EpipolarBand(rig, C, options).curve(left);
  const auto wide = EpipolarBand(rig, 9 * C, options).curve(left);
  ASSERT_EQ(narrow.size(), wide.size());
  ASSERT_GT(narrow.size(), 10);
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    EXPECT_EQ(narrow[i].pixel_px, wide[i].pixel_px);
    EXPECT_TRUE(wide[i].covariance_px2.isApprox(9 * narrow[i].covariance_px2, 1e-12));
  }
}

TEST(EpipolarBand, ALongCurveIsWholeWithinTheImage) {
  // A third of a metre apart and as near as 8 cm: 4000 px of disparity, most of it out of view.
  Rig rig = test::stereo_rig();
  rig.T_camera_first[1].t = {-0.33, 0, 0.02};
  const EpipolarBand band(rig, covariance_of(rig), {.nearest_m = 0.08});
  int seen = 0;
  for (double u = 20; u < 640; u += 50) {
    const auto curve = band.curve({{u, 200}, Eigen::Matrix2d::Zero()});
    const Eigen::Vector3d ray = unproject(rig.cameras[0], {u, 200});
    for (double inverse_depth = 0; inverse_depth < 12.4; inverse_depth += 0.01) {
      const Eigen::Vector3d X =
          rig.T_camera_first[1].R * ray + inverse_depth * rig.T_camera_first[1].t;
      if (X.z() <= 0.1) continue;
      const Eigen::Vector2d pixel = project(rig.cameras[1], X);
      if (!in_image(rig.cameras[1], pixel)) continue;
      const auto back = try_unproject(rig.cameras[1], pixel);  // elsewhere beyond the lens's fold
      if (!back || (*back - X / X.z()).norm() > 1e-6) continue;
      ++seen;
      const double distance =
          distance_to_curve(curve, {pixel, Eigen::Matrix2d::Zero()}).mahalanobis2;
      EXPECT_LT(distance, 0.2) << u << " " << inverse_depth;
    }
  }
  EXPECT_GT(seen, 500);
}

TEST(EpipolarBand, RefusesWhatIsNoPair) {
  Rig rig = test::stereo_rig();
  const Eigen::MatrixXd C = covariance_of(rig);
  EXPECT_EQ(test::error_message([&] { EpipolarBand(rig, C.topLeftCorner(3, 3)); }),
            "rig: the covariance does not have the size of its parameters; use both of one rig");
  EXPECT_EQ(test::error_message([&] { EpipolarBand(rig, C, {.nearest_m = 0}); }),
            "epipolar band: nearest_m is not above 0 or corner_sigma_px is negative; use metres "
            "and pixels");
  rig.cameras.push_back(rig.cameras[1]);
  rig.T_camera_first.push_back(rig.T_camera_first[1]);
  EXPECT_EQ(test::error_message([&] { EpipolarBand(rig, C); }),
            "rig: it has 3 cameras instead of 2; use the rig of the two cameras that took the "
            "images");
}

}  // namespace
}  // namespace vernier
