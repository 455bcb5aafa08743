// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/corners/patch_descriptor.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace vernier::stereo::internal {

namespace {

constexpr int side = 8, spacing_px = 2;
constexpr int reach_px = (side - 1) * spacing_px;  // from the first sample to the last

}  // namespace

PatchDescriptors::PatchDescriptors(const cv::Mat& grey) {
  constexpr double sigma_px = 1;
  cv::GaussianBlur(grey, smoothed_, {}, sigma_px);
}

std::optional<Eigen::VectorXf> PatchDescriptors::at(const Eigen::Vector2d& pixel_px) const {
  constexpr double half = 0.5 * reach_px, least_deviation = 1;
  if (!(pixel_px.x() >= half && pixel_px.y() >= half) ||
      !(pixel_px.x() <= smoothed_.cols - 1 - half && pixel_px.y() <= smoothed_.rows - 1 - half)) {
    return std::nullopt;
  }
  cv::Mat patch;
  cv::getRectSubPix(smoothed_, {reach_px + 1, reach_px + 1},
                    cv::Point2f(static_cast<float>(pixel_px.x()), static_cast<float>(pixel_px.y())),
                    patch);
  Eigen::VectorXf descriptor(side * side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      descriptor[y * side + x] = patch.at<float>(y * spacing_px, x * spacing_px);
    }
  }
  descriptor.array() -= descriptor.mean();
  const float length = descriptor.norm();
  if (!(length >= side * least_deviation)) return std::nullopt;
  return descriptor / length;
}

}  // namespace vernier::stereo::internal
