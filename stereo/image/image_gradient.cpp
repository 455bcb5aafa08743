// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/image/image_gradient.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace vernier::stereo::internal {

GradientKernel::GradientKernel(double scale_px)
    : reach(static_cast<int>(std::lround(3.5 * scale_px))) {
  double sum = 0, moment = 0;
  for (int i = -reach; i <= reach; ++i) {
    const double g = std::exp(-i * i / (2 * scale_px * scale_px));
    smooth.push_back(g);
    slope.push_back(i * g);
    sum += g;
    moment += i * i * g;
  }
  for (double& value : smooth) value /= sum;
  for (double& value : slope) value /= moment;
}

void GradientRows::compute(const cv::Mat& grey, const GradientKernel& kernel, int first, int end) {
  first_row = first;
  const cv::Mat rows = grey.rowRange(first, end);  // the filter reads beyond them
  const auto filter = [&](cv::Mat& to, const auto& along_x, const auto& along_y) {
    cv::sepFilter2D(rows, to, CV_32F, along_x, along_y, {-1, -1}, 0, cv::BORDER_REPLICATE);
  };
  filter(x, kernel.slope, kernel.smooth);
  filter(y, kernel.smooth, kernel.slope);
  cv::magnitude(x, y, strength);
}

}  // namespace vernier::stereo::internal
