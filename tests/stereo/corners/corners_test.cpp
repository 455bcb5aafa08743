// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <optional>

#include "calib/statistics/random.h"
#include "stereo/corners/harris_corners.h"
#include "stereo/image/image_noise.h"
#include "tests/support/wedge_image.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo::internal;

namespace {

constexpr int corners_side = 40;

RandomStream draws_of(std::uint32_t trial, std::uint32_t feature = 0) {
  return RandomStream({.seed = 20, .trial = trial, .feature = feature, .source = 200});
}

/// The corner nearest to a place, if there is one within 3 px.
std::optional<ImageCorner> corner_near(const cv::Mat& image,
                                       double noise,
                                       const Eigen::Vector2d& place) {
  std::optional<ImageCorner> nearest;
  for (const ImageCorner& corner : harris_corners(image, noise)) {
    const double apart = (corner.pixel_px - place).norm();
    if (apart < 3 && (!nearest || apart < (nearest->pixel_px - place).norm())) nearest = corner;
  }
  return nearest;
}

test::Wedge random_wedge(double opening_deg, RandomStream& draws) {
  return {
      {corners_side / 2 + draws.uniform(-0.5, 0.5), corners_side / 2 + draws.uniform(-0.5, 0.5)},
      opening_deg * std::numbers::pi / 180,
      draws.uniform(0, 2 * std::numbers::pi)};
}

class CornersByAngle : public testing::TestWithParam<double> {};

/// Without noise: the mean error along the wedge's axis, the same in every view, and what is left
/// of it, which depends on how the corner lies on the pixels and how it is turned.
TEST_P(CornersByAngle, LieAtOnePlaceInsideTheTipWhereverThePixelsAre) {
  double along = 0, squares = 0;
  int n = 60;
  std::vector<Eigen::Vector2d> errors;
  for (int i = 0; i < n; ++i) {
    RandomStream draws = draws_of(i);
    const test::Wedge wedge = random_wedge(GetParam(), draws);
    const auto corner = corner_near(test::photograph(wedge, corners_side), 1, wedge.tip);
    ASSERT_TRUE(corner) << "wedge " << i;
    const Eigen::Vector2d axis(std::cos(wedge.towards), std::sin(wedge.towards));
    const Eigen::Vector2d error = corner->pixel_px - wedge.tip;
    errors.emplace_back(axis.dot(error), axis.x() * error.y() - axis.y() * error.x());
    along += errors.back().x() / n;
  }
  for (const Eigen::Vector2d& e : errors) {
    squares += (e - Eigen::Vector2d(along, 0)).squaredNorm() / (2.0 * n);
  }
  RecordProperty("bias_px", std::to_string(along));
  RecordProperty("by_place_sd_px", std::to_string(std::sqrt(squares)));
  EXPECT_GT(along, 0);
  EXPECT_LT(along, GetParam() < 75 ? 1.2 : 0.6);
  EXPECT_LT(std::sqrt(squares), 0.08);
}

/// χ² of the error against the noise-free place, by the stated covariance: 2 on average. 400 draws:
/// the mean's standard deviation is 0.1, so 5 of them have a false alarm rate of 6e-7; a tenth
/// more is left for the formula, which is linear in the noise.
TEST_P(CornersByAngle, ErrFromNoiseAsTheirCovarianceSays) {
  constexpr int wedges = 20, copies = 20;
  constexpr double noise = 4;
  double chi2 = 0;
  int n = 0;
  for (int i = 0; i < wedges; ++i) {
    RandomStream place = draws_of(i);
    const cv::Mat clean = test::photograph(random_wedge(GetParam(), place), corners_side);
    const auto truth = corner_near(clean, noise, {corners_side / 2.0, corners_side / 2.0});
    ASSERT_TRUE(truth);
    for (int k = 0; k < copies; ++k) {
      RandomStream draws = draws_of(i, 1 + k);
      const auto corner =
          corner_near(test::with_noise(clean, noise, draws), noise, truth->pixel_px);
      ASSERT_TRUE(corner);
      const Eigen::Vector2d error = corner->pixel_px - truth->pixel_px;
      chi2 += error.dot(corner->covariance_px2.inverse() * error);
      ++n;
    }
  }
  RecordProperty("mean_chi2", std::to_string(chi2 / n));
  EXPECT_NEAR(chi2 / n, 2, 0.2 + 5 * 2 / std::sqrt(n));
}

INSTANTIATE_TEST_SUITE_P(Wedges, CornersByAngle, testing::Values(45, 60, 90, 120));

TEST(Corners, NoiseAloneHasNone) {
  const cv::Mat grey(240, 320, CV_32F, cv::Scalar(120));
  for (const double sigma : {0.0, 1.0, 5.0}) {
    RandomStream draws = draws_of(1);
    const cv::Mat image = test::with_noise(grey, sigma, draws);
    EXPECT_LE(harris_corners(image, image_noise(image)).size(), 2u) << sigma;
  }
}

/// Grey squares of 16 px with values drawn at random: half of the image lies within texture.
cv::Mat squares_image(int width, int height, std::uint32_t trial) {
  RandomStream draws = draws_of(trial, 99);
  cv::Mat small(height / 16, width / 16, CV_32F), image;
  for (int y = 0; y < small.rows; ++y) {
    for (int x = 0; x < small.cols; ++x) small.at<float>(y, x) = float(draws.uniform(30, 220));
  }
  cv::resize(small, image, {width, height}, 0, 0, cv::INTER_NEAREST);
  cv::GaussianBlur(image, image, {0, 0}, 0.6);
  return image;
}

TEST(ImageNoise, IsMeasuredBesideTexture) {
  for (const double sigma : {1.0, 2.0, 5.0}) {
    RandomStream draws = draws_of(7);
    const cv::Mat image = test::with_noise(squares_image(320, 240, 1), sigma, draws);
    const double rounded = std::sqrt(sigma * sigma + 1.0 / 12);
    EXPECT_NEAR(image_noise(image) / rounded, 1, 0.15) << sigma;
  }
  RandomStream draws({29});
  const cv::Mat plain = test::with_noise(cv::Mat(480, 640, CV_32F, cv::Scalar(100)), 3, draws);
  EXPECT_NEAR(image_noise(plain) / std::sqrt(9 + 1.0 / 12), 1, 0.02);
  EXPECT_NEAR(image_noise(cv::Mat(100, 100, CV_8U, cv::Scalar(9))), 1 / std::sqrt(12), 1e-12);
}

TEST(Corners, AreTheStrongestOrSpreadEvenly) {
  cv::Mat image = squares_image(320, 320, 2);
  cv::Mat faint = image(cv::Rect(0, 0, 160, 320));
  faint = 0.3 * faint + 80;  // the left half has less contrast
  RandomStream draws = draws_of(3);
  const cv::Mat grey = test::with_noise(image, 1, draws);
  const auto all = harris_corners(grey, 1, {.count = 0});
  const auto some = harris_corners(grey, 1, {.count = 60});
  const auto even = harris_corners(grey, 1, {.count = 60, .cells = 2});
  ASSERT_EQ(some.size(), 60u);
  ASSERT_EQ(even.size(), 60u);
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(some[i].pixel_px, all[i].pixel_px);
    if (i > 0) {
      EXPECT_GE(some[i - 1].strength, some[i].strength);
    }
  }
  const auto on_left = [](const std::vector<ImageCorner>& corners) {
    return std::count_if(corners.begin(), corners.end(),
                         [](const ImageCorner& c) { return c.pixel_px.x() < 160; });
  };
  EXPECT_LT(on_left(some), 5);
  EXPECT_EQ(on_left(even), 30);
}

TEST(Corners, AreTheSameForAnyNumberOfThreads) {
  RandomStream draws = draws_of(4);
  const cv::Mat grey = test::with_noise(squares_image(640, 480, 3), 2, draws);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = harris_corners(grey, 2);
  cv::setNumThreads(4);
  const auto four = harris_corners(grey, 2);
  cv::setNumThreads(threads);
  ASSERT_EQ(one.size(), four.size());
  ASSERT_GT(one.size(), 300u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].pixel_px, four[i].pixel_px);
    EXPECT_EQ(one[i].covariance_px2, four[i].covariance_px2);
  }
}

}  // namespace
}  // namespace vernier
