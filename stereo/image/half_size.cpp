// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/image/half_size.h"

#include <opencv2/imgproc.hpp>

#include "stereo/grey_levels.h"
#include "stereo/image/matrix_of.h"

namespace vernier::stereo::internal {

cv::Mat half_size(const cv::Mat& image) {
  cv::Mat half;
  cv::resize(image(cv::Rect(0, 0, image.cols / 2 * 2, image.rows / 2 * 2)), half, {}, 0.5, 0.5,
             cv::INTER_AREA);
  return half;
}

GreyLevels half_size(const GreyLevels& image) {
  if (image.width_px < 2 || image.height_px < 2)
    return {image.width_px / 2, image.height_px / 2, {}};
  const cv::Mat half = half_size(matrix_of(image));
  return {half.cols, half.rows, {half.begin<float>(), half.end<float>()}};
}

}  // namespace vernier::stereo::internal
