// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "stereo/canny_edges.h"
#include "stereo/image/image_gradient.h"

namespace vernier::stereo::internal {

/// Sub-pixel edge positions within the pixels of maximum gradient: the peak along the normal n of
/// the least squares quadratic through log |g| in 3 x 3 pixels, and its standard deviation under
/// white image noise (canny_edges.h).
class EdgePlaces {
 public:
  /// `noise` in grey levels; NaN gives NaN standard deviations.
  EdgePlaces(const GradientKernel& kernel, double noise);

  /// Sets everything but the `string` of points that have a pixel, within the gradient's rows.
  void place(const GradientRows& gradient, std::span<EdgePoint> points) const;

 private:
  static constexpr int lanes = 16;  ///< points per batch, for vectorisation
  using Lanes = std::array<float, lanes>;
  struct Batch;

  static void gather(const GradientRows& gradient, std::span<const EdgePoint> points, Batch& batch);
  static void fit(Batch& batch);
  void propagate(Batch& batch) const;

  float noise_;
  /// Noise covariance of the gradients at two pixels, components xx, xy + yx and yy, by their
  /// offset (dx, dy) at [dy * 5 + dx + 2]; both signs of it combined.
  std::array<std::array<float, 3>, 15> correlation_;
};

}  // namespace vernier::stereo::internal
