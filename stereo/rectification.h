// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/rig.h"
#include "stereo/segment.h"

namespace vernier::stereo {

/// Rotations that turn both cameras of a pair to a common orientation in which every epipolar line
/// is a row: x along the baseline from left to right, z as near as can be to the mean of both
/// optical axes. Fusiello, Trucco and Verri, "A compact algorithm for rectification of stereo
/// pairs" (2000).
struct Rectification {
  Eigen::Matrix3d R_rectified_left;
  Eigen::Matrix3d R_rectified_right;
};

/// Throws Error unless the rig is a pair with a baseline above 1 mm.
Rectification rectification(const Rig& rig);

/// Angle of a left-image segment to the epipolar direction, as it stands in the rectified image;
/// radians in [0, pi/2].
double epipolar_angle_rad(const Rig& rig,
                          const Rectification& rectification,
                          const ImageSegment& left);

}  // namespace vernier::stereo
