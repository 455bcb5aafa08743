// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "localise/place.h"

namespace vernier::localise::internal {

/// Depth before which lines are cut, metres.
inline constexpr float nearest_compared_m = 0.25f;

/// The pair of cameras without distortion in which views are compared: pixels of the left camera's
/// focal length from its principal point (u right, v down), and w = 1 / depth; the right camera
/// sees (u, v) - f w eye_m, eye_m its centre.
struct ViewCamera {
  float f_px = 0, baseline_m = 0;
  Eigen::Vector2f eye_m{0, 0};           ///< centre of the right camera: to the right, down
  Eigen::Vector2f along_baseline{1, 0};  ///< its direction in the image, of unit length
  float height_m = 0, cos_pitch = 1, sin_pitch = 0;            ///< of the mount
  float left_px = 0, right_px = 0, top_px = 0, bottom_px = 0;  ///< the image, less a margin
  /// The same of the right camera's image, as seen by one parallel to the left camera: the box
  /// through the middles of its borders.
  Eigen::AlignedBox2f of_right_px;
  /// Borders at which a line beyond nearest_compared_m can leave either image by more than a few
  /// pixels where it is inside the others.
  struct Borders {
    bool own_left = true, left = true, right = true, top = true, bottom = true;
  } cuts;

  float disparity_px_m() const { return f_px * baseline_m; }  ///< times w: a disparity
};

/// The camera of a view. Throws Error for a view without a rig of at least two cameras.
ViewCamera view_camera(const PlaceView& view);

/// u, v, w of a point of the robot frame; its depth must not be 0.
Eigen::Vector3f project(const ViewCamera& camera, const Eigen::Vector3f& point_m);

/// The inverse of project(): the point of the robot frame seen at (u, v, w), w not 0.
Eigen::Vector3f unproject(const ViewCamera& camera, const Eigen::Vector3f& uvw);

/// d (u, v, w) / d (x, y, turn) of a fixed point seen at (u, v, w), for a step of the robot in its
/// own frame.
Eigen::Matrix3f step_jacobian(const ViewCamera& camera, const Eigen::Vector3f& uvw);

}  // namespace vernier::localise::internal
