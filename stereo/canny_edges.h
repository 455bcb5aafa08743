// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "stereo/grey_levels.h"

namespace vernier::stereo {

/// A point of an edge in an image, one a pixel at most.
struct EdgePoint {
  int x = 0, y = 0;          ///< its pixel, where the gradient is the largest across the edge
  Eigen::Vector2f pixel_px;  ///< the edge itself, on the normal through that pixel's centre
  float row_x_px = 0;        ///< where the edge crosses row y; within 1.5 px of x
  Eigen::Vector2f normal;    ///< unit, towards the brighter side
  float strength = 0;        ///< gradient, grey levels a pixel
  float sigma_px = 0;        ///< standard deviation along the normal, from the image's noise
  int string = 0;            ///< connected edge that it is part of
};

struct CannyOptions {
  double scale_px = 1.0;   ///< σ of the Gaussian that the gradient is taken behind
  double low = 2;          ///< grey levels a pixel: weaker points are none
  double high = 5;         ///< grey levels a pixel: a string needs one point as strong
  int min_points = 10;     ///< shorter strings are dropped
  bool with_sigma = true;  ///< else it is not a number, which saves a quarter of the time
};

/// Edges of an image, sorted by (y, x) (Canny, "A computational approach to edge detection", PAMI
/// 8, 1986): pixels where the gradient g behind a Gaussian is largest along its own direction n = g
/// / |g|, in 8-connected strings all of which are above `low` and one of which is above `high`.
///
/// The place is the peak along n of the quadratic that fits log |g| in the 3 x 3 pixels best,
///
///     log |g(c + r)| ~ a + bᵀ r + rᵀ C r,   p = c + t n,   t = −nᵀb / (2 nᵀC n)
///
/// for the gradient across a blurred step is nearly a Gaussian, and its logarithm is a parabola:
/// the place has no bias from the interpolation between pixels. Its standard deviation is that of
/// the linearised formula under the image's own white noise (image_noise.h) of σ grey levels,
///
///     δt = Σ_i q_i nᵀ δg_i,   q_i = ∂t / ∂log|g_i| / |g_i|,   var t = σ² Σ_ij q_i q_j nᵀ R(i − j)
///     n
///
/// with R the autocorrelation of the gradient's filter. It says nothing of what a lens, a shadow or
/// a neighbouring edge displaces (docs/edges.md). Throws Error on an image whose values do not fill
/// it and on options that name no edges; an image smaller than the filter has none.
std::vector<EdgePoint> canny_edges(const GreyLevels& image, const CannyOptions& options = {});

}  // namespace vernier::stereo
