// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/match_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "calib/base/grey_image.h"
#include "cli/program/picture.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/match_images.h"

namespace vernier::cli {
namespace {

constexpr int subpixel_bits = 4;  // for OpenCV drawing functions

cv::Point fixed_point(const Eigen::Vector2d& p, int down) {
  constexpr double unit = 1 << subpixel_bits;
  return {cvRound(p.x() * unit), cvRound((p.y() + down) * unit)};
}

}  // namespace

std::string match_picture(const ImageMatching& matching) {
  const cv::Mat left = read_grey_image(matching.files.left);
  const cv::Mat right = read_grey_image(matching.files.right);
  cv::Mat both(left.rows + right.rows, std::max(left.cols, right.cols), CV_8U, cv::Scalar(0)),
      drawn;
  left.copyTo(both(cv::Rect(0, 0, left.cols, left.rows)));
  right.copyTo(both(cv::Rect(0, left.rows, right.cols, right.rows)));
  cv::cvtColor(both, drawn, cv::COLOR_GRAY2BGR);
  double most = 1;
  for (const CornerMatch& m : matching.matches)
    most = std::max(most, (m.right_px - m.left_px).norm());
  for (const CornerMatch& m : matching.matches) {
    const cv::Scalar c = blue_to_red(1 - (m.right_px - m.left_px).norm() / most);
    const cv::Point from = fixed_point(m.left_px, 0), to = fixed_point(m.right_px, 0);
    const cv::Point below = fixed_point(m.right_px, left.rows);
    cv::line(drawn, from, to, c, 1, cv::LINE_AA, subpixel_bits);
    cv::circle(drawn, from, 2 << subpixel_bits, c, 1, cv::LINE_AA, subpixel_bits);
    cv::circle(drawn, below, 2 << subpixel_bits, c, 1, cv::LINE_AA, subpixel_bits);
  }
  return png_of(drawn);
}

}  // namespace vernier::cli
