// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

namespace vernier::stereo::internal {

struct AlignmentOptions {
  /// Patches of 2 half + 1 pixels, weighted by a Gaussian with σ of half their half-size.
  int half_px = 7;
  double max_shift_px = 1;  ///< maximum distance from the start
  /// A, by which an offset in the left image becomes one in the right image before the stretch.
  Eigen::Matrix2d right_by_left = Eigen::Matrix2d::Identity();
  /// Minimum noise of the images, standard deviation, grey levels.
  double noise_left = 0, noise_right = 0;
};

struct Alignment {
  Eigen::Vector2d right_px;        ///< position corresponding to the left pixel
  Eigen::Matrix2d covariance_px2;  ///< of the alignment
  double score = 0;                ///< weighted ZNCC of the aligned patches
};

/// Least squares matching (Förstner 1982; Grün 1985): finds the right pixel q at which the left
/// patch I appears in the right image K,
///
///     K(q + D i) = α I(p + i) + β,   D = A + d (s, h),   |i| <= half
///
/// with shift, gain, offset, and stretch s and shear h along d, the `direction` in the right image,
/// which is how a slanted plane changes the disparity. Iterations are inverse compositional (Baker
/// and Matthews 2004): gradients of the left patch only. Covariance s²/α² N⁻¹ (Jᵀ W² J) N⁻¹ with s²
/// the residuals' weighted mean square, at least that of the image noise; errors from non-planar
/// surfaces are not included. Returns nullopt if it does not converge, moves too far, or needs a
/// gain beyond 3 or a stretch beyond 0.6. Images are grey levels as CV_32F.
std::optional<Alignment> align_patch(const cv::Mat& left,
                                     const cv::Mat& right,
                                     const Eigen::Vector2d& left_px,
                                     const Eigen::Vector2d& right_px,
                                     const Eigen::Vector2d& direction,
                                     const AlignmentOptions& options = {});

/// Grey level at a sub-pixel position of a CV_32F image, by cubic convolution (Keys 1981, a =
/// -1/2); the border is replicated.
double grey_between(const cv::Mat& image, double x, double y);

}  // namespace vernier::stereo::internal
