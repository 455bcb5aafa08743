// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

namespace vernier::stereo::internal {

struct AlignmentOptions {
  int half_px = 7;  ///< patches of 2 half + 1 pixels, under a Gaussian of half their half-size
  double max_shift_px = 1;                 ///< from where it began
  double noise_left = 0, noise_right = 0;  ///< least noise of the images, grey values
};

struct Alignment {
  Eigen::Vector2d right_px;        ///< what is seen at the left pixel
  Eigen::Matrix2d covariance_px2;  ///< of that registration
  double score = 0;                ///< weighted ZNCC of the patches as aligned
};

/// Least squares matching (Förstner 1982; Grün 1985): the right pixel at which the left patch I is
/// seen in the right image K,
///
///     K(q + D i) = α I(p + i) + β,   D = 1 + d (s, h),   |i| <= half
///
/// with shift, gain, offset, and stretch s and shear h along `direction`, which is how the
/// disparity of a slanted plane acts. Steps are those of the inverse composition (Baker and
/// Matthews 2004): gradients of the left patch only. Covariance s²/α² N⁻¹ (Jᵀ W² J) N⁻¹ with s² the
/// residuals' weighted mean square, at least that of the images' noise; it knows nothing of
/// surfaces that are not planes. Nothing where it does not settle, moves too far, or needs a gain
/// beyond 3 or a stretch beyond 0.6. Images are grey values as CV_32F.
std::optional<Alignment> align_patch(const cv::Mat& left,
                                     const cv::Mat& right,
                                     const Eigen::Vector2d& left_px,
                                     const Eigen::Vector2d& right_px,
                                     const Eigen::Vector2d& direction,
                                     const AlignmentOptions& options = {});

/// Grey value between pixels of a CV_32F image, by cubic convolution (Keys 1981, a = -1/2); beyond
/// the border, its outermost pixels'.
double grey_between(const cv::Mat& image, double x, double y);

}  // namespace vernier::stereo::internal
