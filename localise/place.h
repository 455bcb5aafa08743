// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "stereo/segment.h"

namespace vernier::localise {

/// Where a robot stands on the floor: world frame, metres; heading from +x, counter-clockwise.
struct Pose2D {
  double x_m = 0, y_m = 0, heading_rad = 0;
};

/// Distance on the floor.
double distance_m(const Pose2D& a, const Pose2D& b);
/// Difference of headings a - b in (-pi, pi]: positive where a is counter-clockwise from b, and pi
/// where they are opposite.
double heading_difference_rad(const Pose2D& a, const Pose2D& b);
/// Where `step`, given in the frame of `from`, is in the world.
Pose2D compose(const Pose2D& from, const Pose2D& step);

/// How the left camera sits on the robot. Robot frame: x forward, y left, z up, origin on the
/// floor below the camera.
struct CameraMount {
  double height_m = 1.2;
  double pitch_rad = 0;  ///< nose down positive
};
Pose T_robot_camera(const CameraMount& mount);

enum class LineKind { vertical, level, oblique };

/// An edge in the robot's frame.
struct PlaceLine {
  Eigen::Vector3d a_m, b_m;
  LineKind kind = LineKind::oblique;
  double sigma_m = 0;  ///< standard deviation of its distance from the robot
  double length_m() const { return (b_m - a_m).norm(); }
};

struct PlaceLineOptions {
  double max_range_m = 10;       ///< lines farther off along the floor are left out
  double max_sigma_m = 0.45;     ///< so are lines known less well than this
  double vertical_slope = 0.12;  ///< image slope |du/dv| below which a line may be vertical
  double level_slope = 0.35;     ///< rise over run below which a line counts as level
};

/// What a robot knows of one place from one look: lines in space, and the image lines.
struct PlaceView {
  std::vector<PlaceLine> lines;                   ///< reliable ones only
  std::vector<stereo::ImageSegment> image_lines;  ///< left image, all
};

/// Brings triangulated segments into the robot's frame. A line that may be vertical (its image
/// nearly so and the depths of its ends equal within their error) is made exactly vertical at its
/// mean depth: in a building that is what it is, and its tilt would be noise.
PlaceView select_lines(std::span<const stereo::SpaceSegment> segments,
                       std::span<const stereo::StereoSegment> images,
                       const CameraMount& mount,
                       const PlaceLineOptions& options = {});

}  // namespace vernier::localise
