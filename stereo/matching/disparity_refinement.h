// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/grey_levels.h"
#include "stereo/image/padded_image.h"

namespace vernier::stereo::internal {

/// Start of a refinement: the point's pixel in the left image and the initial warp to the right
/// image.
struct RefinementStart {
  int x = 0, y = 0;
  float disparity_px = 0;
  float stretch = 1;  ///< du_right / du_left
  float shear = 0;    ///< du_right / dv
};

struct RefinedDisparity {
  bool settled = false;
  float disparity_px = 0;  ///< at the pixel's centre
  float stretch = 1, shear = 0;
  float sigma_px = 0;  ///< of the disparity, from the residuals, at least that of the image noise
  float score = 0;     ///< ZNCC of the aligned patches
};

struct RefinementOptions {
  float noise_left = 1, noise_right = 1;  ///< white, standard deviation, grey levels
  float slope_variance = 0.5f;  ///< of a central difference of the left image, from its noise
  float max_shift_px = 1;       ///< maximum distance from the start …
  float start_sigma_px = 0.5f;  ///< … which has this standard deviation
  float stretch_sigma = 0.3f;   ///< expected deviation of stretch and shear from their start
  int iterations = 6;
};

/// Least squares matching along the row (Förstner 1982; Grün 1985) of patches of 9 x 7 pixels: the
/// right image K is related to the left image I by
///
///     K(x − d + r i + s j, y + j) = α I(x + i, y + j) + β,   |i| <= 4, |j| <= 3
///
/// with shift, stretch r, shear s, gain α and offset β unknown and all pixels weighted equally.
/// Steps of r and s are damped as by weak priors, so that an edge without texture around it stays
/// near the start. Iterations are inverse compositional (Baker and Matthews 2004): gradients of the
/// left patch only; they stop after a step below 0.05 px, which leaves about a tenth of it. With N
/// the normal matrix, the variance of the disparity is r² m N⁻¹₀₀ / α², m the mean squared
/// residual, at least (noise_left² α² + noise_right²). The gradients have noise themselves, of
/// which N⁻¹₀₀ takes the squares for information. The share of it that is the edge's is
///
///     q = 1 − 58 v N⁻¹₀₀,   at least 0.2
///
/// with v the variance of a gradient, and the deviation is divided by q. It is at most that of a
/// place between −max_shift and max_shift of the start.
class DisparityRefiner {
 public:
  DisparityRefiner(const GreyLevels& left,
                   const GreyLevels& right,
                   const RefinementOptions& options);

  std::vector<RefinedDisparity> refine(const std::vector<RefinementStart>& starts) const;

 private:
  PaddedImage left_, right_;
  RefinementOptions options_;
};

}  // namespace vernier::stereo::internal
