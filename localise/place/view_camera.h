// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "localise/place.h"

namespace vernier::localise::internal {

/// The pair of cameras without distortion in which views are compared: pixels of the left camera's
/// focal length from its principal point (u right, v down), and w = 1 / depth; the right camera
/// sees (u, v) - f B w times the baseline's direction.
struct ViewCamera {
  float f_px = 0, baseline_m = 0;
  float baseline_u = 1, baseline_v = 0;  ///< the baseline's direction in the image, of unit length
  float height_m = 0, cos_pitch = 1, sin_pitch = 0;            ///< of the mount
  float left_px = 0, right_px = 0, top_px = 0, bottom_px = 0;  ///< the image, less a margin

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
