// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace vernier::stereo::internal {

struct HarrisOptions {
  int count = 400;                 ///< at most so many, the strongest; 0: all
  int cells = 0;                   ///< spread evenly over cells x cells parts of the image; 0: not
  double gradient_scale_px = 0.7;  ///< σ of the Gaussian the gradient is taken behind
  double integration_scale_px = 1.5;  ///< σ of the window that a corner is one in
  double k = 0.06;                    ///< of the response; larger refuses more edges
  int suppression_radius_px = 2;      ///< no stronger response within, in rows and columns
  double worst_sigma_px = 0.25;       ///< corners with a larger standard deviation are left out
  double max_shift_px = 2.5;          ///< from the response's peak to the corner's point
  int border_px = 9;                  ///< none nearer to the image's border
};

struct ImageCorner {
  Eigen::Vector2d pixel_px;
  Eigen::Matrix2d covariance_px2;  ///< of the pixel, from the image's noise
  double strength = 0;             ///< Harris' response at the peak
};

/// Corners of an image, the strongest first (Harris and Stephens, "A combined corner and edge
/// detector", 1988): peaks of
///
///     R = det M − k (tr M)²,   M = Σ w g gᵀ
///
/// with g the gradient and w a Gaussian window. The corner's place is then Förstner's point
/// (Förstner and Gülch 1987), the one nearest to all lines along the edges in the window about the
/// peak c,
///
///     p = M⁻¹ Σ w g gᵀ x
///
/// At the tip of a wedge it lies inside by 0.3 to 1.1 px, the more the sharper, and scatters by
/// less than 0.1 px with the place on the pixels (docs/matching.md). Its covariance is that of the
/// linearised formula under white noise of `noise` grey values,
///
///     δp = M⁻¹ Σ w (e δg + g δgᵀ (x − p)) + ∂p/∂c δc,   e = gᵀ (x − p)
///
/// with the correlation that the gradient's filter gives to δg and the peak's own motion δc: no
/// factor is fitted. It holds for the place at which the noise-free image would have the corner;
/// that this is not quite the same point of the scene in another view is beyond it.
std::vector<ImageCorner> harris_corners(const cv::Mat& grey,
                                        double noise,
                                        const HarrisOptions& options = {});

}  // namespace vernier::stereo::internal
