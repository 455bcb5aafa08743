// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/stereo/disparity_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

#include "cli/program/picture.h"
#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

namespace vernier::cli {
namespace {

constexpr int enlarged = 2;  // so that adjacent edges can be distinguished

/// Uses few grey levels to keep the file small.
cv::Mat faded(const GreyLevels& image) {
  constexpr int step = 12;
  cv::Mat canvas(image.height_px, image.width_px, CV_8UC3);
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      const int level = static_cast<int>(image(x, y)) / (3 * step);
      const auto grey = cv::saturate_cast<uchar>(170 + step * level);
      canvas.at<cv::Vec3b>(y, x) = {grey, grey, grey};
    }
  }
  cv::resize(canvas, canvas, {}, enlarged, enlarged, cv::INTER_NEAREST);
  return canvas;
}

void mark(cv::Mat& canvas, const EdgePoint& edge, const cv::Scalar& colour) {
  cv::rectangle(canvas, cv::Rect(enlarged * edge.x, enlarged * edge.y, enlarged, enlarged), colour,
                cv::FILLED);
}

}  // namespace

std::string disparity_picture(const GreyLevels& image,
                              const std::vector<EdgePoint>& edges,
                              const std::vector<EdgeDisparity>& found,
                              const DisparityRange& range) {
  cv::Mat canvas = faded(image);
  const double span = std::max(1, range.max_px - range.min_px);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    mark(canvas, edges[i],
         found[i].matched() ? blue_to_red((found[i].disparity_px - range.min_px) / span)
                            : cv::Scalar(120, 120, 120));
  }
  return png_of(canvas);
}

std::string error_picture(const GreyLevels& image,
                          const std::vector<EdgePoint>& edges,
                          const std::vector<double>& errors_px) {
  cv::Mat canvas = faded(image);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double error = std::abs(errors_px[i]);
    cv::Scalar colour(0, 0, 0);  // BGR; no ground truth
    if (std::isinf(error)) colour = {230, 90, 30};
    if (error <= 0.5) colour = {60, 160, 20};
    if (error > 0.5 && error <= 1) colour = {0, 200, 230};
    if (error > 1 && error <= 3) colour = {0, 120, 255};
    if (error > 3 && !std::isinf(error)) colour = {20, 20, 220};
    mark(canvas, edges[i], colour);
  }
  return png_of(canvas);
}

}  // namespace vernier::cli
