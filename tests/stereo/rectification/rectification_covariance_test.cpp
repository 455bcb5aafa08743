// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/rectification/rectification_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "stereo/rectification.h"
#include "stereo/rectification/vertical_disparity.h"
#include "tests/support/calibrations_covariance.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

/// (d, dy) of a raw pair in the images that a rig rectifies, at a focal length and centre.
Eigen::Vector2d disparities(const Rig& rig, const RectifiedGeometry& at, const PixelPair& raw) {
  RectifiedGeometry g = at;
  g.turn = rectification(rig);
  return rectified_pixel(rig, g, 0, raw.first_px).value() -
         rectified_pixel(rig, g, 1, raw.other_px).value();
}

TEST(RectificationCovariance, DerivativesAreThoseOfDifferences) {
  for (const char* model : {"pinhole", "radial1", "opencv4", "opencv5", "opencv8", "fisheye4"}) {
    const Rig rig = test::stereo_rig(camera_model(model));
    const RectifiedGeometry g = rectified_geometry(rig);
    const RectificationUncertainty uncertainty(rig, test::calibrations_covariance(rig).matrix, g);
    for (const auto& left_px : {Eigen::Vector2d(320, 240), {600, 20}, {150, 430}}) {
      const PixelPair raw{raw_pixel(rig, g, 0, left_px).value(),
                          raw_pixel(rig, g, 1, left_px - Eigen::Vector2d(40, 0)).value()};
      const Eigen::MatrixXd numeric = test::numeric_jacobian(
          [&](const Eigen::VectorXd& delta) -> Eigen::VectorXd {
            return disparities(retract(rig, delta), g, raw);
          },
          Eigen::VectorXd::Zero(parameter_count(rig)), 1e-5);
      const Eigen::MatrixXd ours = uncertainty.by_rig(left_px, 40).value();
      EXPECT_LT((ours - numeric).cwiseAbs().maxCoeff(), 1e-7 * numeric.cwiseAbs().maxCoeff())
          << model << " at " << left_px.transpose();
      // The vertical row, by the essential matrix instead.
      const Eigen::RowVectorXd vertical = *vertical_disparity_by_rig(rig, raw, g.f_px);
      EXPECT_LT((ours.row(1) - vertical).cwiseAbs().maxCoeff(), 1e-9 * vertical.norm()) << model;
    }
  }
}

/// What no pixel can show: the length of the baseline, and for cameras side by side both centres
/// moved alike. A right centre moved by itself shows one to one.
TEST(RectificationCovariance, GaugeFacts) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  const RectificationUncertainty uncertainty(rig, test::calibrations_covariance(rig).matrix, g);
  Eigen::VectorXd longer = Eigen::VectorXd::Zero(parameter_count(rig));
  longer.tail<3>() = rig.T_camera_first[1].t;
  const auto J = uncertainty.by_rig({200, 100}, 30).value();
  EXPECT_LT((J * longer).norm(), 1e-10 * J.norm() * longer.norm());

  Rig level = test::stereo_rig(Pinhole{});
  level.cameras[1].parameters = level.cameras[0].parameters;
  level.T_camera_first[1] = Pose{Eigen::Matrix3d::Identity(), {-0.2, 0, 0}};
  const RectifiedGeometry same = rectified_geometry(level, {.f_px = level.cameras[0].f_px()});
  const auto by_rig =
      RectificationUncertainty(level, test::calibrations_covariance(level).matrix, same)
          .by_rig({200, 100}, 30)
          .value();
  Eigen::VectorXd centres = Eigen::VectorXd::Zero(14);
  centres[2] = centres[6] = 1;  // left and right ox_px
  EXPECT_LT((by_rig * centres).norm(), 1e-10);
  centres[3] = centres[7] = 2;  // and oy_px
  EXPECT_LT((by_rig * centres).norm(), 1e-10);
  EXPECT_NEAR(by_rig(0, 6), 1 / level.cameras[1].ax(), 1e-9);
  EXPECT_NEAR(by_rig(1, 7), 1, 1e-9);
  EXPECT_NEAR(by_rig(0, 7), 0, 1e-9);
}

/// Turning the rectified pair about its baseline, which is a choice, leaves e = x1ᵀ E x0 and so the
/// vertical disparity but for its scale: f / z of the rectified rays.
TEST(RectificationCovariance, TurnAboutTheBaselineScalesTheVerticalPart) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig, {.f_px = 500});
  const PixelPair raw{raw_pixel(rig, g, 0, {300, 200}).value(),
                      raw_pixel(rig, g, 1, {260, 200}).value()};
  const Rig moved = retract(rig, 1e-6 * Eigen::VectorXd::Ones(parameter_count(rig)));
  const auto dy = [&](const Rig& by, double angle) {
    RectifiedGeometry turned = g;
    turned.turn = rectification(by);
    const Eigen::Matrix3d turn = rotation_from_vector({angle, 0, 0});
    turned.turn.R_rectified_left = turn * turned.turn.R_rectified_left;
    turned.turn.R_rectified_right = turn * turned.turn.R_rectified_right;
    const Eigen::Vector3d ray =
        turned.turn.R_rectified_left * unproject(by.cameras[0], raw.first_px);
    // n = (0, n_y, n_z) with n·ray = 0; dy = −f e / (z n_y), so dy z n_y / |n| is the choice's no
    // more
    const double n_y = ray.z() / std::hypot(ray.y(), ray.z());
    const Eigen::Vector3d right =
        turned.turn.R_rectified_right * unproject(by.cameras[1], raw.other_px);
    return (rectified_pixel(by, turned, 0, raw.first_px).value() -
            rectified_pixel(by, turned, 1, raw.other_px).value())
               .y() *
           right.z() * n_y;
  };
  EXPECT_NEAR(dy(moved, 0.05), dy(moved, 0), 1e-5 * std::abs(dy(moved, 0)));
  EXPECT_GT(std::abs(dy(moved, 0)), 1e-6);
}

/// Rigs drawn at ψ = 0.05 read the same raw pairs. Whitened by the linear covariance, the n − 1
/// sampled variances of either component are χ² and their correlation is normal with 1/√n: nine
/// statistics over three pixels, false-alarm rate 1e-3 over all (seed 41 fixed).
TEST(RectificationCovariance, SampledIsTheLinearOneAtSmallPsi) {
  RigEstimate estimate;
  estimate.rig = test::stereo_rig();
  estimate.covariance = test::calibrations_covariance(estimate.rig);
  const RectifiedGeometry g = rectified_geometry(estimate.rig);
  const RectificationUncertainty uncertainty(estimate.rig, estimate.covariance->matrix, g);
  const RigSampler sampler(estimate);
  const int n = 3000;
  const double psi = 0.05, p = 1e-3 / 9;
  for (const auto& left_px : {Eigen::Vector2d(320, 240), {600, 20}, {150, 430}}) {
    const PixelPair raw{raw_pixel(estimate.rig, g, 0, left_px).value(),
                        raw_pixel(estimate.rig, g, 1, left_px - Eigen::Vector2d(40, 0)).value()};
    const Eigen::Matrix2d linear = psi * psi * uncertainty.covariance_px2(left_px, 40).value();
    const Eigen::Matrix2d whiten = linear.llt().matrixL().toDenseMatrix().inverse();
    Eigen::MatrixXd e(2, n);
    for (int i = 0; i < n; ++i) {
      const Rig drawn = sampler.sample(psi, 41, static_cast<std::uint32_t>(i));
      e.col(i) = whiten * (disparities(drawn, g, raw) - Eigen::Vector2d(40, 0));
    }
    e.colwise() -= e.rowwise().mean();
    for (int k = 0; k < 2; ++k) {
      EXPECT_GT(e.row(k).squaredNorm(), chi_squared_quantile(p / 2, n - 1));
      EXPECT_LT(e.row(k).squaredNorm(), chi_squared_quantile(1 - p / 2, n - 1));
    }
    EXPECT_LT(std::abs(e.row(0).dot(e.row(1))) / std::sqrt(n), normal_quantile(1 - p / 2));
    EXPECT_GT(linear(0, 0), 0.1 * linear(1, 1));  // or the test would tell little of d
  }
}

/// Where a straight edge crosses a row, by the middle grey value.
double crossing(const cv::Mat& image, int y) {
  for (int x = 1; x < image.cols; ++x) {
    const float a = image.at<float>(y, x - 1), b = image.at<float>(y, x);
    if ((a < 100) != (b < 100)) return x - 1 + (100.0 - a) / (b - a);
  }
  return NAN;
}

/// The sign, on images: an edge through both, the right image moved by (−d, −dy).
TEST(RectificationCovariance, VerticalErrorMovesAnEdgeAsItsNormalSays) {
  for (const double theta : {0.4, 0.9, 1.57, 2.2, 2.8}) {
    const Eigen::Vector2d normal(-std::sin(theta), std::cos(theta));
    for (const double dy : {1.5, -0.7}) {
      const double d = 12.3;
      const auto edge = [&](double dx, double shift_y) {
        cv::Mat image(120, 200, CV_32F);
        for (int y = 0; y < image.rows; ++y) {
          for (int x = 0; x < image.cols; ++x) {
            const double along = normal.dot(Eigen::Vector2d(x + dx - 110, y + shift_y - 60));
            image.at<float>(y, x) = static_cast<float>(100 + 50 * std::erf(along / 2));
          }
        }
        return image;
      };
      const cv::Mat left = edge(0, 0), right = edge(d, dy);  // right(x − d, y − dy) = left(x, y)
      const double found = crossing(left, 60) - crossing(right, 60);
      EXPECT_NEAR(found - d, normal.y() / normal.x() * dy, 0.02) << theta << ' ' << dy;
      // So a rig whose only error is that dy has this variance.
      const Eigen::Vector2d errors(0, dy);
      EXPECT_NEAR(std::sqrt(disparity_variance_px2(errors * errors.transpose(), normal)),
                  std::abs(found - d), 0.02);
      // And one whose dy comes with a d adds or takes away as it should.
      const Eigen::Vector2d both(0.5, dy);
      EXPECT_NEAR(std::sqrt(disparity_variance_px2(both * both.transpose(), -normal)),
                  std::abs(found - d + 0.5), 0.02);
    }
  }
  EXPECT_TRUE(std::isinf(disparity_variance_px2(Eigen::Matrix2d::Identity(), {0, 1})));
}

TEST(RectificationCovariance, BadInputIsNamed) {
  const Rig rig = test::stereo_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  EXPECT_THROW(RectificationUncertainty(rig, Eigen::MatrixXd::Identity(3, 3), g), Error);
  Rig folded = test::stereo_rig(Radial1{});
  for (Camera& camera : folded.cameras) camera.parameters[4] = -0.6;
  const RectifiedGeometry wide = rectified_geometry(folded, {.f_px = 300});
  const RectificationUncertainty u(folded, test::calibrations_covariance(folded).matrix, wide);
  EXPECT_FALSE(u.covariance_px2(wide.centre_px + Eigen::Vector2d(315, 0), 5).has_value());
}

}  // namespace
}  // namespace vernier
