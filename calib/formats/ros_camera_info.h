// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/formats/imported_rig.h"

namespace vernier::internal {

/// ROS's sensor_msgs/CameraInfo as YAML: the format of camera_calibration_parsers (image_width,
/// camera_matrix, …) or the message itself (width, K, D, R, P; k, d, r, p in ROS 2).
///
///     x_rectified = R x_camera,   pixel ~ P (x_rectified, 1),   P = K' [I | t]
///
/// For a pair, R of each camera takes it to the common rectified orientation and P of the right one
/// carries the baseline, P03 = fx' tx. Distortion is plumb_bob (k1 k2 p1 p2 k3),
/// rational_polynomial (k1 … k6) or equidistant (fisheye4).
struct RosCameraInfo {
  Camera camera;
  Eigen::Matrix3d R_rectified_camera = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 3, 4> P = Eigen::Matrix<double, 3, 4>::Zero();
  /// Keys by which the images that are published are a part of those of the camera, or reduced: the
  /// intrinsics are those of the whole.
  std::vector<std::string> not_applied;
};

RosCameraInfo parse_ros_camera_info(const std::string& text,
                                    const std::string& place,
                                    const ImportOptions& options = {});

/// A rig of one or two files, the left one first. The relative pose of a pair is recovered from the
/// rectification:
///
///     R = R_rect_rightᵀ R_rect_left,   T = R_rect_rightᵀ (t_right - t_left),
///     t = (P03/P00, P13/P11, 0)
///
/// Throws Error if the two P give no baseline, and for more than two files, since CameraInfo has no
/// poses. A camera is named by camera_name, else after its file.
ImportedRig read_ros_camera_info(const std::vector<std::filesystem::path>& files,
                                 const ImportOptions& options = {});

/// NAME.yaml in the layout of camera_calibration_parsers. For a pair, use the infos of
/// stereo/rectification/rectified_camera_info.h.
ExportedFile format_ros_camera_info(const RosCameraInfo& info);

}  // namespace vernier::internal
