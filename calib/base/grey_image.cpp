// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/base/grey_image.h"

#include <opencv2/imgcodecs.hpp>

#include "calib/base/image_file.h"

namespace vernier::internal {

cv::Mat read_grey_image(const std::filesystem::path& file) {
  cv::Mat grey =
      decode_image(read_image_bytes(file), cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH, file);
  if (grey.depth() == CV_8U) return grey;
  double largest = 0;
  cv::minMaxLoc(grey, nullptr, &largest);
  cv::Mat scaled;
  grey.convertTo(scaled, CV_8U, largest > 0 ? 255 / largest : 1);
  return scaled;
}

}  // namespace vernier::internal
