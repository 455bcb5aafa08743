// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/image_fault.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/statistics/quantile.h"

namespace vernier::internal {
namespace {

std::array<int, 256> histogram(const cv::Mat& grey) {
  std::array<int, 256> count{};
  for (int y = 0; y < grey.rows; ++y) {
    const auto* row = grey.ptr<unsigned char>(y);
    for (int x = 0; x < grey.cols; ++x) ++count[row[x]];
  }
  return count;
}

/// The smallest grey value that at least this fraction of the pixels do not exceed.
int percentile(const std::array<int, 256>& count, double share, double pixels) {
  double sum = 0;
  for (int value = 0; value < 256; ++value) {
    sum += count[value];
    if (sum >= share * pixels) return value;
  }
  return 255;
}

/// Steepest edges, grey values per pixel, by the Sobel operator.
double steepest(const cv::Mat& grey) {
  cv::Mat dx, dy, gradient;
  cv::Sobel(grey, dx, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(grey, dy, CV_32F, 0, 1, 3, 1.0 / 8);
  cv::magnitude(dx, dy, gradient);
  std::vector<float> values(gradient.begin<float>(), gradient.end<float>());
  return quantile(std::move(values), 0.999, QuantileKind::lower);
}

}  // namespace

std::string image_fault(const cv::Mat& grey) {
  const auto count = histogram(grey);
  const double pixels = static_cast<double>(grey.total());
  const int low = percentile(count, 0.01, pixels), high = percentile(count, 0.99, pixels);
  const double white = (count[254] + count[255]) / pixels;
  if (white > 0.5) {
    return fmt::format("over-exposed: {:.0f} % of the pixels are white", 100 * white);
  }
  if (percentile(count, 0.9, pixels) < 16) {
    return fmt::format("under-exposed: nine tenths of the pixels are at {} or below",
                       percentile(count, 0.9, pixels));
  }
  if (high - low < 40) {
    return fmt::format("low contrast: grey values of {} to {}", low, high);
  }
  const double width = (high - low) / std::max(steepest(grey), 1e-3);
  if (width > 9) return fmt::format("blurred: its sharpest edges are {:.0f} px wide", width);
  return "";
}

}  // namespace vernier::internal
