// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "calib/camera/opencv_intrinsics.h"
#include "calib/pose.h"
#include "stereo/image/depth_image.h"

namespace vernier::sim::internal {

/// A pinhole camera at its place.
struct PlacedCamera {
  vernier::internal::OpenCvIntrinsics k;
  Eigen::Vector2i size_px;
  Pose T_camera_world;

  Eigen::Vector2d pixel(const Eigen::Vector3d& in_camera) const {
    return {k.fx_px * in_camera.x() / in_camera.z() + k.cx_px,
            k.fy_px * in_camera.y() / in_camera.z() + k.cy_px};
  }
  /// The ray (x, y, 1) of a pixel.
  Eigen::Vector3d ray(const Eigen::Vector2d& px) const {
    return {(px.x() - k.cx_px) / k.fx_px, (px.y() - k.cy_px) / k.fy_px, 1};
  }
};

/// A straight line in the image of a camera, as samples a pixel apart.
struct LineInView {
  Eigen::Vector2d from_px, along, across;  ///< first sample; unit vectors
  std::vector<Eigen::Vector3d> at_m;       ///< of each sample, in the camera's frame
  std::vector<char> shown;                 ///< whether it is expected there; all, to begin with

  int shown_count() const;
  double length_px() const { return static_cast<double>(at_m.size()); }
};

/// The part of the segment from a to b (world frame) in the image, `margin_px` inside its border,
/// beyond 0.1 m; nothing if it is shorter than 2 px.
std::optional<LineInView> line_in_view(const PlacedCamera& camera,
                                       const Eigen::Vector3d& a_m,
                                       const Eigen::Vector3d& b_m,
                                       double margin_px);

/// Clears `shown` where no depth within 4 px across the line is within floor + share · z of the
/// line's depth z: something hides it there, or it is not there.
void keep_where_depths_agree(const stereo::internal::DepthImage& depth,
                             double floor_m,
                             double share,
                             LineInView& line);

}  // namespace vernier::sim::internal
