// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/image/image_noise.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/statistics/quantile.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

constexpr int block = 16;
constexpr double min_noise = 0.2886751345948129;  // 1/√12

/// The lower quintile. With the spread of a block's own estimate, 8.6 % (256 values of n that are
/// correlated with their neighbours), it is 8 % below the mean if no block has texture.
double lower_quintile(const std::vector<double>& values) {
  return 1.08 * quantile(values, 0.2, QuantileKind::upper);
}

}  // namespace

double image_noise(const cv::Mat& grey) {
  cv::Mat n;
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::filter2D(grey, n, CV_32F, kernel);
  std::vector<double> whole, cut;
  for (int y = 1; y + block < grey.rows; y += block) {
    for (int x = 1; x + block < grey.cols; x += block) {
      const cv::Rect rect(x, y, block, block);
      double low = 0, high = 0;
      cv::minMaxLoc(grey(rect), &low, &high);
      const double rms = cv::norm(n(rect)) / (6 * block);
      (low <= 0 || high >= 255 ? cut : whole).push_back(rms);
    }
  }
  std::vector<double>& used = whole.empty() ? cut : whole;
  return used.empty() ? min_noise : std::max(min_noise, lower_quintile(used));
}

}  // namespace vernier::stereo::internal
