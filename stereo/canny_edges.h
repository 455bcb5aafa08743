// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "stereo/grey_levels.h"

namespace vernier::stereo {

/// An edge point of an image, at most one per pixel.
struct EdgePoint {
  int x = 0, y = 0;          ///< pixel of maximum gradient across the edge
  Eigen::Vector2f pixel_px;  ///< sub-pixel position, on the normal through that pixel's centre
  float row_x_px = 0;        ///< where the edge crosses row y; within 1.5 px of x
  Eigen::Vector2f normal;    ///< unit, towards the brighter side
  float strength = 0;        ///< gradient magnitude, grey levels per pixel
  float sigma_px = 0;        ///< standard deviation along the normal, from the image noise
  int string = 0;            ///< index of the connected edge that it belongs to
};

struct CannyOptions {
  double scale_px = 1.0;  ///< σ of the Gaussian filter that precedes the gradient
  double low = 2;  ///< hysteresis threshold below which points are discarded, grey levels per pixel
  /// Hysteresis threshold: an edge needs one point above it, grey levels per pixel.
  double high = 5;
  int min_points = 10;  ///< shorter edges are dropped
  /// White noise of the image, grey levels; 0: estimated from it. An image that is interpolated
  /// from another one shows too little of it: interpolation takes the high frequencies by which
  /// noise is estimated, and leaves those that move edges. Give that of the image it is made from.
  double noise = 0;
  bool with_sigma = true;  ///< false: sigma_px is NaN, which saves a quarter of the time
};

/// Edges of an image, sorted by (y, x) (Canny, "A computational approach to edge detection", PAMI
/// 8, 1986): pixels where the magnitude of the Gaussian-smoothed gradient g is a maximum along its
/// own direction n = g / |g|, linked into 8-connected edges that lie above `low` and exceed `high`
/// at one point at least.
///
/// The sub-pixel position is the peak along n of the least squares quadratic through log |g| in the
/// 3 x 3 neighbourhood,
///
///     log |g(c + r)| ~ a + bᵀ r + rᵀ C r,   p = c + t n,   t = −nᵀb / (2 nᵀC n)
///
/// The gradient across a blurred step is nearly a Gaussian and its logarithm a parabola, so
/// interpolation adds no bias. The standard deviation follows from the linearised formula with
/// white image noise (image_noise.h) of σ grey levels,
///
///     δt = Σ_i q_i nᵀ δg_i,   q_i = ∂t / ∂log|g_i| / |g_i|
///     var t = σ² Σ_ij q_i q_j nᵀ R(i − j) n
///
/// with R the autocorrelation of the gradient filter. It does not include displacements by a lens,
/// a shadow or a neighbouring edge (docs/edges.md). Throws Error if the number of values does not
/// match the image size and for options out of range; an image smaller than the filter has no
/// edges.
std::vector<EdgePoint> canny_edges(const GreyLevels& image, const CannyOptions& options = {});

}  // namespace vernier::stereo
