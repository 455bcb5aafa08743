// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "stereo/segment.h"

namespace vernier::localise {

/// Robot pose on the floor: world frame, metres; heading from +x, counter-clockwise.
struct Pose2D {
  double x_m = 0, y_m = 0, heading_rad = 0;

  bool operator==(const Pose2D& other) const = default;
};

/// Euclidean distance on the floor.
double distance_m(const Pose2D& a, const Pose2D& b);
/// Heading difference a - b in (-pi, pi]: positive if a is counter-clockwise from b, pi if they are
/// opposite.
double heading_difference_rad(const Pose2D& a, const Pose2D& b);
/// Whether two poses differ by less than so much in position and in heading.
bool is_close_to(const Pose2D& a, const Pose2D& b, double within_m, double within_rad);
/// Composes `step`, given in the frame of `from`, into the world frame.
Pose2D compose(const Pose2D& from, const Pose2D& step);
/// The step that leads from one pose to another, in the frame of `from`: the inverse of compose().
Pose2D relative(const Pose2D& to, const Pose2D& from);

/// Pose of the left camera on the robot. Robot frame: x forward, y left, z up, origin on the floor
/// below the camera.
struct CameraMount {
  double height_m = 1.2;
  double pitch_rad = 0;  ///< positive: pointing down
};
Pose T_robot_camera(const CameraMount& mount);

enum class LineKind { vertical, level, oblique };

/// A line in the robot frame.
struct PlaceLine {
  Eigen::Vector3d a_m, b_m;
  LineKind kind = LineKind::oblique;
  double sigma_m = 0;  ///< standard deviation of its distance from the robot
  double length_m() const { return (b_m - a_m).norm(); }
};

struct PlaceLineOptions {
  double max_range_m = 10;       ///< lines farther away along the floor are dropped
  double max_sigma_m = 0.45;     ///< lines with a larger sigma_m are dropped
  double vertical_slope = 0.12;  ///< maximum image slope |du/dv| of a line considered vertical
  double level_slope = 0.35;     ///< maximum rise over run of a line considered level
};

/// A corner seen by both cameras of a rig at one moment.
struct StereoCorner {
  Eigen::Vector2d left_px, right_px;  ///< in the images as taken
  /// Of left u, v, right u, v, px². What moves the corner in both images alike, as its change of
  /// appearance from one moment to the next, is in the off-diagonal blocks.
  Eigen::Matrix4d covariance_px2 = 0.09 * Eigen::Matrix4d::Identity();
  /// Appearance, of unit length: the dot product of two is their similarity, in [-1, 1].
  Eigen::VectorXf descriptor;
};

/// A robot's view of a place: lines in space and image lines, and corners where they are asked for.
struct PlaceView {
  std::vector<PlaceLine> lines;                   ///< reliable lines only
  std::vector<stereo::ImageSegment> image_lines;  ///< of the left image, those matched in stereo
  std::shared_ptr<const Rig> rig = nullptr;  ///< the estimated rig, from which lines are computed
  CameraMount mount = {};
  std::vector<StereoCorner> corners = {};  ///< for methods on points; mostly left out
  /// Of the left image, without a partner in the right one, as those along epipolar lines. Errors
  /// of the pose between the cameras leave them alone. Of a map's views they are not kept.
  std::vector<stereo::ImageSegment> monocular_lines = {};
};

/// One of several views from the same position.
struct Look {
  PlaceView view;
  double turn_rad = 0;  ///< its heading minus that of the first look
};

/// Transforms triangulated segments to the robot frame. A line that may be vertical (its image is
/// nearly so and the depths of its ends are equal within their error) is made exactly vertical at
/// its mean depth: in buildings such lines are vertical, and the tilt would be noise. The view's
/// rig is left empty.
PlaceView select_lines(std::span<const stereo::SpaceSegment> segments,
                       std::span<const stereo::StereoSegment> images,
                       const CameraMount& mount,
                       const PlaceLineOptions& options = {});

}  // namespace vernier::localise
