// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

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

}  // namespace vernier::stereo
