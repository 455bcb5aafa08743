// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/rig.h"
#include "stereo/segment.h"

namespace vernier::stereo {

/// Rotations that turn both cameras of a pair to a common orientation in which every epipolar line
/// is a row: x along the baseline from left to right, z as near as can be to the mean of both
/// optical axes. Fusiello, Trucco and Verri, "A compact algorithm for rectification of stereo
/// pairs" (2000).
struct Rectification {
  Eigen::Matrix3d R_rectified_left;
  Eigen::Matrix3d R_rectified_right;
};

/// Throws Error unless the rig is a pair with a baseline above 1 mm.
Rectification rectification(const Rig& rig);

/// Angle of a left-image segment to the epipolar direction, as it stands in the rectified image;
/// radians in [0, pi/2].
double epipolar_angle_rad(const Rig& rig,
                          const Rectification& rectification,
                          const ImageSegment& left);

struct RectifiedGeometryOptions {
  Eigen::Vector2i size_px{0, 0};  ///< of the rectified images; 0 0: the left camera's
  double f_px = 0;                ///< of both; 0: chosen as below
  double max_blank = 0.01;        ///< share of either image's pixels that may have no source …
  double min_zoom = 0.7;          ///< … by a focal length within these two,
  double max_zoom = 1.3;          ///< in units of the cameras' mean
};

/// Two pinhole cameras side by side that a pair is rectified to: the same focal length f, the same
/// centre c, no distortion. With B the baseline,
///
///     u = f x / z + c_x,   v = f y / z + c_y,   d = u_left − u_right,   z = f B / d
///
/// for a point (x, y, z) of the rectified left camera's frame, R_rectified_left x_left
struct RectifiedGeometry {
  Rectification turn;
  double f_px = 0;
  Eigen::Vector2d centre_px{0, 0};
  double baseline_m = 0;
  Eigen::Vector2i size_px{0, 0};

  double depth_m(double disparity_px) const { return f_px * baseline_m / disparity_px; }
  double disparity_px(double depth_m) const { return f_px * baseline_m / depth_m; }
};

/// The geometry that a rig's images are rectified to.
///
/// The focal length is the least, so the widest view, at which no more than `max_blank` of either
/// image has no source; where none within the zooms does, the most zoom. Where the cameras' mean is
/// within 3 % of it, it is the mean, so that cameras side by side stay as they are. The centre is
/// such that the middles of both raw images stay in the middle on average: where the axes converge
/// or part, either image loses what the other cannot see. Throws Error unless the rig is a pair
/// with a baseline, and on options out of bounds.
RectifiedGeometry rectified_geometry(const Rig& rig, const RectifiedGeometryOptions& options = {});

/// The geometry of images that are rectified already, by the rig of two pinhole cameras side by
/// side that takes them: its own f and B, the left camera's centre. Where the right camera's centre
/// lies further right by o, the images' disparities are those of the geometry less o. Nothing where
/// the rig is none of that kind.
std::optional<RectifiedGeometry> geometry_of_rectified_rig(const Rig& rig);

/// The two pinhole cameras as a rig of the same names.
Rig rectified_rig(const Rig& rig, const RectifiedGeometry& geometry);

/// Where camera 0 or 1 has in its raw image what is at a rectified pixel, inside of it or not. It
/// takes no inverse of the lens. Nothing behind the camera or beyond the fold of its distortion.
std::optional<Eigen::Vector2d> raw_pixel(const Rig& rig,
                                         const RectifiedGeometry& geometry,
                                         int camera,
                                         const Eigen::Vector2d& rectified_px);

/// The other way. Nothing where the raw pixel has no ray or it is not in front of the rectified
/// camera.
std::optional<Eigen::Vector2d> rectified_pixel(const Rig& rig,
                                               const RectifiedGeometry& geometry,
                                               int camera,
                                               const Eigen::Vector2d& raw_px);

}  // namespace vernier::stereo
