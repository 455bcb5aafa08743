// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/program/picture.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/base/image_file.h"

namespace vernier::cli {

cv::Scalar blue_to_red(double share) {
  const double hue = 120 * (1 - std::clamp(share, 0.0, 1.0));
  const cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar(cvRound(hue), 255, 225));
  cv::Mat bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  const auto c = bgr.at<cv::Vec3b>(0, 0);
  return {double(c[0]), double(c[1]), double(c[2])};
}

std::string png_of(const cv::Mat& picture) {
  return vernier::internal::png_of(picture, {cv::IMWRITE_PNG_COMPRESSION, 9});
}

}  // namespace vernier::cli
