// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// A line of a normalised image,
///
///     x cos(theta) + y sin(theta) = rho,
///
/// as the vector (cos theta, sin theta, -rho): the normal of the plane through line and camera.
using ImageLine = Eigen::Vector3d;

/// A line in space, in the left camera's frame, metres.
struct SpaceLine {
  Eigen::Vector3d point_m;
  Eigen::Vector3d direction;  ///< of unit length
};

/// The same line in both normalised images.
struct StereoLine {
  ImageLine left, right;
};

/// A line as both cameras see it and as the rig that is told places it in space.
struct SeenLine {
  StereoLine image;
  SpaceLine space;
  double length_px = 0;  ///< in the left image
};

/// Undistorts the ends of a matched pair of image lines and intersects the planes through them; the
/// point is on the ray of the left line's middle. Nothing if a pixel has no ray, within 4
/// degrees of the epipolar plane, and beyond 30 m or behind the rig.
std::optional<SeenLine> see(const Rig& told, const stereo::StereoSegment& segment);

/// The images of a line in space. Pose of the right camera: T_right_left.
StereoLine image_of(const SpaceLine& line, const Pose& T_right_left);

SpaceLine moved(const SpaceLine& line, const Pose& T_to_from);

/// How the line in one image changes with the motion of its camera, `line` in this camera's frame:
/// rates of rho and theta by (v, w), the camera's velocity in its own frame. It is the interaction
/// matrix of Espiau, Chaumette and Rives, "A new approach to visual servoing in robotics", IEEE
/// Trans. Robotics and Automation 8(3), 1992, section III-B, in Plücker's coordinates: with N = P x
/// u, scaled as ImageLine, and u scaled alike,
///
///     dN/dt = -v x u - w x N,   dtheta = cos dN_y - sin dN_x,   drho = -dN_z - rho (cos dN_x + sin
///     dN_y)
Eigen::Matrix<double, 2, 6> interaction(const SpaceLine& line);

/// The same for rho and theta in the left and then in the right image, by the motion of a robot on
/// the floor that carries the rig: forward and to the left (metres), counter-clockwise (radians).
/// The signs of rho are those of `like`, the same line.
Eigen::Matrix<double, 4, 3> floor_interaction(const SpaceLine& line,
                                              const StereoLine& like,
                                              const Pose& T_right_left,
                                              const localise::CameraMount& mount);

/// rho and theta of `line` minus those of `from`, left and right. The senses are those of `from`.
Eigen::Vector4d difference(const StereoLine& line, const StereoLine& from);

/// The pose that a constant motion (forward, left, turn), as of floor_interaction(), leads to: the
/// exponential of SE(2).
localise::Pose2D floor_motion(const Eigen::Vector3d& motion);

/// Coordinates of the left camera at `to` from those of the left camera at `from`, for two poses of
/// the robot in one frame.
Pose T_left_left(const localise::Pose2D& to,
                 const localise::Pose2D& from,
                 const localise::CameraMount& mount);

}  // namespace vernier::sim::internal
