// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calib/statistics/random.h"

namespace vernier::test {

using namespace vernier::internal;

/// A corner of known place: a bright wedge with its tip at `tip`, opening by `opening` radians
/// about the direction `towards`.
struct Wedge {
  Eigen::Vector2d tip{0, 0};
  double opening = std::numbers::pi / 2, towards = 0;
  double dark = 60, bright = 180;
};

/// What a camera makes of it: pixels integrate over their squares (8 x 8 samples) behind a Gaussian
/// point spread of `blur_px`. No noise, not rounded (CV_32F).
inline cv::Mat photograph(const Wedge& wedge, int side_px, double blur_px = 0.5) {
  constexpr int fine = 8;
  cv::Mat image(fine * side_px, fine * side_px, CV_32F);
  const Eigen::Vector2d axis(std::cos(wedge.towards), std::sin(wedge.towards));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d d =
          Eigen::Vector2d((x + 0.5) / fine - 0.5, (y + 0.5) / fine - 0.5) - wedge.tip;
      const double angle = std::abs(std::atan2(axis.x() * d.y() - axis.y() * d.x(), axis.dot(d)));
      image.at<float>(y, x) =
          static_cast<float>(angle < wedge.opening / 2 ? wedge.bright : wedge.dark);
    }
  }
  cv::GaussianBlur(image, image, {0, 0}, fine * blur_px, 0, cv::BORDER_REPLICATE);
  cv::Mat pixels;
  cv::resize(image, pixels, {side_px, side_px}, 0, 0, cv::INTER_AREA);
  return pixels;
}

/// With white noise, as 8-bit grey values.
inline cv::Mat with_noise(const cv::Mat& image, double sigma, RandomStream& draws) {
  cv::Mat noisy(image.size(), CV_8U);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      noisy.at<uchar>(y, x) =
          cv::saturate_cast<uchar>(image.at<float>(y, x) + sigma * draws.normal());
    }
  }
  return noisy;
}

}  // namespace vernier::test
