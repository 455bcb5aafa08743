// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "sim/images/image_scene.h"

namespace vernier::sim::internal {

/// Depth along the optical axis, metres, at the pixel centres, in double precision: of the plane of
/// the face that is hit, or of the smallest figure painted there; NaN where nothing is hit.
/// Row-major.
std::vector<double> depths_m(const ImageScene& scene,
                             const Camera& camera,
                             const Pose& T_camera_world,
                             int threads = 1);

/// The same along any rays (x / z, y / z) of the camera, NaN for one that is not finite.
std::vector<double> depths_along(const ImageScene& scene,
                                 const Pose& T_camera_world,
                                 const std::vector<Eigen::Vector2d>& rays,
                                 int threads = 1);

}  // namespace vernier::sim::internal
