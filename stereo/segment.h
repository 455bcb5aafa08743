// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace vernier::stereo {

/// A straight edge in an image, end points in pixels.
struct ImageSegment {
  Eigen::Vector2d a_px, b_px;

  double length_px() const { return (b_px - a_px).norm(); }
};

/// The same edge in both images of a pair: the lines correspond, the end points need not.
struct StereoSegment {
  ImageSegment left, right;
  std::uint32_t feature = 0;  ///< identity for scoring only; not used by any estimator
};

/// An edge in space, in the rig's frame (metres), with its uncertainty.
struct SpaceSegment {
  Eigen::Vector3d a_m, b_m;
  double depth_sigma_m = 0;  ///< of the farther end, from the end-point error of the line fit
  bool reliable = true;      ///< false: beyond max_depth_m, behind a camera, or a pixel has no ray
};

}  // namespace vernier::stereo
