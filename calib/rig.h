// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"

namespace vernier {

/// Cameras fixed relative to each other; the first camera's frame is the rig's.
///
/// Parameter vector, in this order and with these names:
///
///     left.f_px left.ax left.ox_px left.oy_px left.k1 … right.f_px … right.k1
///     right.wx_rad right.wy_rad right.wz_rad right.tx_m right.ty_m right.tz_m
///
/// that is the intrinsics of every camera, then the pose of every camera but the first.
struct Rig {
  std::vector<Camera> cameras;
  std::vector<Pose> T_camera_first;  ///< one per camera, the first the identity
};

std::vector<std::string> parameter_names(const Rig& rig);
int parameter_count(const Rig& rig);

/// Values in the order of the names; a rotation as its rotation vector. Throws Error if the number
/// of a camera's parameters is not that of its model, or of poses not that of cameras.
Eigen::VectorXd parameters(const Rig& rig);

/// The rig moved by `delta` in its tangent: intrinsics add, a rotation becomes exp([w]x) R (left
/// tangent, radians), a translation adds. Covariances are expressed in this tangent. Throws Error
/// if the size of `delta` is not the number of parameters, and as parameters() does.
Rig retract(const Rig& rig, const Eigen::VectorXd& delta);

/// The delta with retract(from, delta) = to. Throws Error for other cameras, and as parameters().
Eigen::VectorXd difference(const Rig& to, const Rig& from);

/// First index of a camera's intrinsics, and of its pose (camera >= 1). Throws Error for others.
int intrinsics_index(const Rig& rig, int camera);
int pose_index(const Rig& rig, int camera);

/// A camera and its pose, before the rig's frame is chosen.
struct PlacedCamera {
  Camera camera;
  Pose T_camera_reference;
};

/// The rig in the frame of the first camera: T_i_first = T_i_reference T_first_reference⁻¹. Cameras
/// without a name, or with a repeated one, are named left, right, camera2 …
Rig rig_of(std::vector<PlacedCamera> cameras);

/// Default camera names: left, right, camera2 ….
std::string default_camera_name(std::size_t index);

}  // namespace vernier
