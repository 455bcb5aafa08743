// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/formats/ros_camera_info.h"
#include "calib/rig.h"

namespace vernier::stereo::internal {

/// CameraInfo of every camera of a rig.
///
/// A pair's is that of its rectification (stereo/rectification.h): one K' for both, its focal
/// length the mean of theirs, its centre such that the images' centres stay in the middle; the
/// right one's P has the baseline, P03 = -f' |T|. From R, P of both the pose is recovered
/// (read_ros_camera_info). A camera by itself, and each of three or more, has R = I, P = [K | 0]:
/// of three or more the poses are lost.
std::vector<vernier::internal::RosCameraInfo> rectified_camera_info(const Rig& rig);

}  // namespace vernier::stereo::internal
