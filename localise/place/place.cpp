// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/place.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calib/error.h"
#include "calib/pose.h"
#include "stereo/segment.h"

namespace vernier::localise {

using namespace stereo;

namespace {

/// Whether the depths of the ends are equal within their error.
bool may_be_vertical(const SpaceSegment& segment,
                     const ImageSegment& image,
                     const PlaceLineOptions& options) {
  const Eigen::Vector2d d = (image.b_px - image.a_px).cwiseAbs();
  if (d.x() > options.vertical_slope * d.y() + 1) return false;
  const double depth = 0.5 * (segment.a_m.z() + segment.b_m.z());
  return std::abs(segment.a_m.z() - segment.b_m.z()) < 0.15 * depth + 3 * segment.depth_sigma_m;
}

LineKind kind_of(const Eigen::Vector3d& a,
                 const Eigen::Vector3d& b,
                 const PlaceLineOptions& options) {
  const Eigen::Vector3d d = b - a;
  const double run = d.head<2>().norm();
  return std::abs(d.z()) < options.level_slope * run ? LineKind::level : LineKind::oblique;
}

}  // namespace

double distance_m(const Pose2D& a, const Pose2D& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

double heading_difference_rad(const Pose2D& a, const Pose2D& b) {
  const double turn = -std::remainder(b.heading_rad - a.heading_rad, 2 * std::numbers::pi);
  return turn <= -std::numbers::pi ? std::numbers::pi : turn;
}

bool is_close_to(const Pose2D& a, const Pose2D& b, double within_m, double within_rad) {
  return distance_m(a, b) < within_m && std::abs(heading_difference_rad(a, b)) < within_rad;
}

Pose2D compose(const Pose2D& from, const Pose2D& step) {
  const double c = std::cos(from.heading_rad), s = std::sin(from.heading_rad);
  return {from.x_m + c * step.x_m - s * step.y_m, from.y_m + s * step.x_m + c * step.y_m,
          from.heading_rad + step.heading_rad};
}

Pose2D relative(const Pose2D& to, const Pose2D& from) {
  const double c = std::cos(from.heading_rad), s = std::sin(from.heading_rad);
  const double x = to.x_m - from.x_m, y = to.y_m - from.y_m;
  return {c * x + s * y, -s * x + c * y, heading_difference_rad(to, from)};
}

Pose T_robot_camera(const CameraMount& mount) {
  Eigen::Matrix3d R_level;  // camera x right, y down, z forward; robot x forward, y left, z up
  R_level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d R_pitch = rotation_from_vector({0, mount.pitch_rad, 0});
  return {R_pitch * R_level, {0, 0, mount.height_m}};
}

PlaceView select_lines(std::span<const SpaceSegment> segments,
                       std::span<const StereoSegment> images,
                       const CameraMount& mount,
                       const PlaceLineOptions& options) {
  if (segments.size() != images.size()) {
    throw Error("place view", "segments and image lines differ in number",
                "give one image line per segment");
  }
  const Pose T = T_robot_camera(mount);
  PlaceView view;
  view.mount = mount;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    view.image_lines.push_back(images[i].left);
    const SpaceSegment& segment = segments[i];
    if (!segment.reliable || !(segment.depth_sigma_m <= options.max_sigma_m)) continue;
    PlaceLine line{T * segment.a_m, T * segment.b_m, LineKind::oblique, segment.depth_sigma_m};
    if (may_be_vertical(segment, images[i].left, options)) {
      const Eigen::Vector2d mean = 0.5 * (line.a_m + line.b_m).head<2>();
      const auto upright = [&](const Eigen::Vector3d& end) {
        // Moves it along its ray to the mean distance, which corrects the height as well.
        const double scale = mean.norm() / std::max(end.head<2>().norm(), 1e-9);
        return Eigen::Vector3d(mean.x(), mean.y(),
                               mount.height_m + scale * (end.z() - mount.height_m));
      };
      line = {upright(line.a_m), upright(line.b_m), LineKind::vertical,
              segment.depth_sigma_m / std::sqrt(2.0)};
    } else {
      line.kind = kind_of(line.a_m, line.b_m, options);
    }
    const Eigen::Vector3d middle = 0.5 * (line.a_m + line.b_m);
    if (middle.head<2>().norm() <= options.max_range_m && line.length_m() > 1e-6) {
      view.lines.push_back(line);
    }
  }
  return view;
}

}  // namespace vernier::localise
