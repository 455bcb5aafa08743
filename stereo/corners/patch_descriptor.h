// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

namespace vernier::stereo::internal {

/// Appearance of an image around its corners: 8 x 8 grey levels 2 px apart, of the image smoothed
/// with a Gaussian of σ = 1 px, less their mean and scaled to unit length. The dot product of two
/// is then the correlation (ZNCC) of their patches.
class PatchDescriptors {
 public:
  explicit PatchDescriptors(const cv::Mat& grey);  ///< CV_32F

  /// std::nullopt if the patch does not lie in the image, or has no texture: a standard deviation
  /// of its grey levels below 1.
  std::optional<Eigen::VectorXf> at(const Eigen::Vector2d& pixel_px) const;

 private:
  cv::Mat smoothed_;
};

}  // namespace vernier::stereo::internal
