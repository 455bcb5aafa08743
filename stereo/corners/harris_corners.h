// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace vernier::stereo::internal {

struct HarrisOptions {
  int count = 400;  ///< maximum number of corners, strongest first; 0: all
  int cells = 0;    ///< distributes corners evenly over a grid of cells x cells; 0: off
  double gradient_scale_px = 0.7;     ///< σ of the Gaussian derivative filter
  double integration_scale_px = 1.5;  ///< σ of the integration window
  double k = 0.06;                    ///< Harris' k; larger values suppress more edge responses
  int suppression_radius_px = 2;      ///< radius of non-maximum suppression, in rows and columns
  double worst_sigma_px = 0.25;       ///< corners with a larger standard deviation are dropped
  double max_shift_px = 2.5;  ///< maximum distance of the refined corner from the response peak
  int border_px = 9;          ///< no corners closer to the image border
};

struct ImageCorner {
  Eigen::Vector2d pixel_px;
  Eigen::Matrix2d covariance_px2;  ///< of the pixel, from the image noise
  double strength = 0;             ///< Harris response at the peak
};

/// Corners of an image, strongest first (Harris and Stephens, "A combined corner and edge
/// detector", 1988): peaks of
///
///     R = det M − k (tr M)²,   M = Σ w g gᵀ
///
/// with g the gradient and w a Gaussian window. The position is refined to Förstner's point
/// (Förstner and Gülch 1987), the point closest to all edge tangents in the window around the peak
/// c,
///
///     p = M⁻¹ Σ w g gᵀ x
///
/// At the tip of a wedge it lies 0.3 to 1.1 px inside, more for sharper wedges, and varies by less
/// than 0.1 px with the sub-pixel phase (docs/matching.md). The covariance follows from the
/// linearised formula with white noise of `noise` grey levels,
///
///     δp = M⁻¹ Σ w (e δg + g δgᵀ (x − p)) + ∂p/∂c δc,   e = gᵀ (x − p)
///
/// with the correlation of δg from the gradient filter and the peak's own motion δc; no factor is
/// fitted. It describes the position relative to the noise-free image; that another view shows a
/// slightly different scene point is not included.
std::vector<ImageCorner> harris_corners(const cv::Mat& grey,
                                        double noise,
                                        const HarrisOptions& options = {});

}  // namespace vernier::stereo::internal
