// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/rig.h"
#include "stereo/corners/harris_corners.h"

namespace vernier::stereo::internal {

/// A grey image with its corners, reduced if things are larger in it than in the other image of its
/// pair.
struct CornerImage {
  cv::Mat grey;                      ///< as CV_32F
  double noise = 0;                  ///< of `grey`, standard deviation, grey levels
  double reduction = 1;              ///< pixels of the image as taken, per pixel of `grey`
  std::vector<ImageCorner> corners;  ///< pixels and covariances in the image as taken

  /// A pixel of `grey`, from that of the image as taken, and back.
  Eigen::Vector2d reduced(const Eigen::Vector2d& pixel_px) const;
  Eigen::Vector2d raw(const Eigen::Vector2d& reduced_px) const;
};

/// Measures the noise of an 8-bit image, reduces it, and detects its corners. Before a reduction by
/// r the image is smoothed by a Gaussian of σ = √(r² − 1) / 2 px, so that a blur of half a pixel
/// remains half a pixel.
CornerImage corner_image(const cv::Mat& grey, const HarrisOptions& options, double reduction = 1);

struct CornerImages {
  CornerImage left, right;
};

/// Both images of a pair. The partner of a left corner may be among the weakest in the right image,
/// so the right image gets half as many corners more. If distant things are larger in one image by
/// more than 3 %, that image is reduced (to an eighth at most), since corners are repeated, and
/// patches alike, at one scale only. Larger in the geometric mean of what is seen in the middle of
/// the left image and of the right one, so that like cameras that are verged keep their images; or
/// of the one that both see.
CornerImages corner_images(const cv::Mat& left,
                           const cv::Mat& right,
                           const Rig& rig,
                           const HarrisOptions& options);

}  // namespace vernier::stereo::internal
