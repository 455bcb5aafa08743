// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/rig.h"
#include "stereo/segment.h"

namespace vernier::stereo {

/// Rotations of both cameras of a pair to a common orientation in which every epipolar line is a
/// row: x along the baseline from left to right, z as close as possible to the mean of both optical
/// axes. Fusiello, Trucco and Verri, "A compact algorithm for rectification of stereo pairs"
/// (2000).
struct Rectification {
  Eigen::Matrix3d R_rectified_left;
  Eigen::Matrix3d R_rectified_right;
};

/// Throws Error unless the rig has two cameras and a baseline of at least 1 mm.
Rectification rectification(const Rig& rig);

/// Angle between a left-image segment and the epipolar direction in the rectified image; radians in
/// [0, pi/2].
double epipolar_angle_rad(const Rig& rig,
                          const Rectification& rectification,
                          const ImageSegment& left);

}  // namespace vernier::stereo
