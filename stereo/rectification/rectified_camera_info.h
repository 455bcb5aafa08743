// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/formats/ros_camera_info.h"
#include "calib/rig.h"

namespace vernier::stereo::internal {

/// CameraInfo of every camera of a rig.
///
/// For a pair it is that of the rectification (stereo/rectification.h): one K' for both, with the
/// mean of both focal lengths and a principal point that keeps the image centres in the middle; P
/// of the right camera has the baseline, P03 = -f' |T|. The pose can be recovered from R and P of
/// both (read_ros_camera_info). For a single camera and for three or more, R = I and P = [K | 0]:
/// the poses of three or more are lost.
std::vector<vernier::internal::RosCameraInfo> rectified_camera_info(const Rig& rig);

}  // namespace vernier::stereo::internal
