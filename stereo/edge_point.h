// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

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

}  // namespace vernier::stereo
