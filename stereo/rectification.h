// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/rig.h"
#include "stereo/segment.h"

namespace vernier::stereo {

/// Rotations of both cameras of a pair to a common orientation in which every epipolar line is a
/// row: x along the baseline from left to right, z as close as possible to the mean of both optical
/// axes. Fusiello, Trucco and Verri, "A compact algorithm for rectification of stereo pairs"
/// (2000).
struct Rectification {
  Eigen::Matrix3d R_rectified_left;
  Eigen::Matrix3d R_rectified_right;
};

/// Throws Error unless the rig has two cameras and a baseline of at least 1 mm.
Rectification rectification(const Rig& rig);

/// Angle between a left-image segment and the epipolar direction in the rectified image; radians in
/// [0, pi/2]. Nothing if an end has no ray (try_unproject), or one behind
/// the rectified camera.
std::optional<double> epipolar_angle_rad(const Rig& rig,
                                         const Rectification& rectification,
                                         const ImageSegment& left);

struct RectifiedGeometryOptions {
  Eigen::Vector2i size_px{0, 0};  ///< of the rectified images; 0 0: that of the left camera, turned
  double f_px = 0;                ///< of both; 0: automatic, see below
  double max_blank = 0.01;  ///< maximum fraction of either image's pixels without a source …
  double min_zoom = 0.7;    ///< … for a focal length between min_zoom
  double max_zoom = 1.3;    ///< and max_zoom times the cameras' mean
};

/// Two parallel pinhole cameras that a pair is rectified to: the same focal length f and principal
/// point c, no distortion. With B the baseline,
///
///     u = f x / z + c_x,   v = f y / z + c_y,   d = u_left − u_right,   z = f B / d
///
/// for a point (x, y, z) of the rectified left camera frame, R_rectified_left x_left
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
/// The focal length is the smallest, hence the widest view, for which at most `max_blank` of either
/// image has no source; the largest zoom if none within the limits does. If the cameras' mean is
/// within 3 % of it, the mean is used, so that parallel cameras keep their focal length. The
/// principal point is chosen such that the centres of both raw images stay in the middle on
/// average: if the axes converge or diverge, each image loses what the other cannot see. Throws
/// Error unless the rig has two cameras and a baseline, and for options out of range.
RectifiedGeometry rectified_geometry(const Rig& rig, const RectifiedGeometryOptions& options = {});

/// The geometry of images that are already rectified, from the rig of the two parallel pinhole
/// cameras that take them: its own f and B, the left camera's principal point. If the right
/// camera's principal point lies further right by o, the images' disparities are those of the
/// geometry minus o. Returns nullopt for any other rig.
std::optional<RectifiedGeometry> geometry_of_rectified_rig(const Rig& rig);

/// The two pinhole cameras as a rig with the same camera names.
Rig rectified_rig(const Rig& rig, const RectifiedGeometry& geometry);

/// Position in the raw image of camera 0 or 1 of a rectified pixel, inside the image or not. Does
/// not invert the lens distortion. Returns nullopt behind the camera or beyond the fold of its
/// distortion. Throws Error for another camera.
std::optional<Eigen::Vector2d> raw_pixel(const Rig& rig,
                                         const RectifiedGeometry& geometry,
                                         int camera,
                                         const Eigen::Vector2d& rectified_px);

/// The inverse. Returns nullopt if the raw pixel cannot be unprojected or is not in front of the
/// rectified camera. Throws Error for another camera.
std::optional<Eigen::Vector2d> rectified_pixel(const Rig& rig,
                                               const RectifiedGeometry& geometry,
                                               int camera,
                                               const Eigen::Vector2d& raw_px);

}  // namespace vernier::stereo
