// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "stereo/canny_edges.h"
#include "stereo/image/image_gradient.h"

namespace vernier::stereo::internal {

/// Where the edges are in the pixels that the gradient is largest in, across it: the peak along the
/// normal n of the quadratic that fits log |g| in 3 x 3 pixels best, and the standard deviation
/// that the image's white noise gives it (canny_edges.h).
class EdgePlaces {
 public:
  /// `noise` in grey levels; if it is not a number, nor are the standard deviations.
  EdgePlaces(const GradientKernel& kernel, double noise);

  /// Fills in all but the string of points that have a pixel, within the gradient's rows.
  void place(const GradientRows& gradient, std::span<EdgePoint> points) const;

 private:
  static constexpr int lanes = 16;  ///< points at a time, for the compiler to make vectors of
  using Lanes = std::array<float, lanes>;
  struct Batch;

  static void gather(const GradientRows& gradient, std::span<const EdgePoint> points, Batch& batch);
  static void fit(Batch& batch);
  void propagate(Batch& batch) const;

  float noise_;
  /// Noise of the gradients at two pixels, products of their components xx, xy + yx and yy, by
  /// their distance (dx, dy) at [dy * 5 + dx + 2]; both signs of it in one.
  std::array<std::array<float, 3>, 15> correlation_;
};

}  // namespace vernier::stereo::internal
