// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/floor_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "calib/base/all_within.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/statistics/quantile.h"
#include "localise/place.h"
#include "localise/views/camera_poses.h"
#include "localise/views/depth_view.h"

namespace vernier::cli {

std::pair<int, int> up_axis(const std::string& word) {
  const bool down = word.starts_with('-');
  const std::string axis = word.substr(down ? 1 : 0);
  if (axis != "x" && axis != "y" && axis != "z") {
    throw Error("--up", "is no axis of the world", "give x, y, z, -x, -y or -z");
  }
  return {axis[0] - 'x', down ? -1 : 1};
}

namespace {

FloorPose above_floor(const Pose& T_world_camera,
                      const FloorPoseOptions& options,
                      const std::string& place) {
  const auto [axis, sign] = up_axis(options.up);
  constexpr double farthest_m = 1e4;
  if (!all_within(T_world_camera.t, farthest_m)) {
    throw Error(options.poses, "its pose of " + place + " is farther than 10 km from its origin",
                "give metres, from an origin near the views");
  }
  FloorPose pose{level_pose(T_world_camera, axis, sign, place), {}};
  LevelPose& level = pose.level;
  level.height_m += options.height_m;
  if (!(level.height_m > 0)) {
    throw Error(place, fmt::format("its camera is {:.2f} m above the floor", level.height_m),
                "give the height of the poses' origin above the floor, --height-m, and --up");
  }
  const Eigen::Matrix3d R_floor_robot = rotation_from_vector({0, 0, level.pose.heading_rad});
  pose.T_floor_camera = {R_floor_robot * T_robot_camera({}).R * level.R_level_camera,
                         {level.pose.x_m, level.pose.y_m, level.height_m}};
  return pose;
}

}  // namespace

std::vector<FloorPose> floor_poses(const FloorPoseOptions& options,
                                   const std::vector<std::filesystem::path>& images) {
  return floor_poses(read_poses_of_camera(options.poses), options, images);
}

std::vector<FloorPose> floor_poses(const CameraPoses& poses,
                                   const FloorPoseOptions& options,
                                   const std::vector<std::filesystem::path>& images) {
  const std::vector<Pose> of_images = poses_of_images(poses, images, options.poses);
  std::vector<FloorPose> all;
  for (std::size_t i = 0; i < of_images.size(); ++i) {
    all.push_back(above_floor(of_images[i], options, images[i].string()));
  }
  return all;
}

std::string tilt_doubt(const std::vector<double>& down) {
  constexpr double unlikely_deg = 60;
  std::vector<double> tilts_deg;
  for (const double part : down) {
    tilts_deg.push_back(std::acos(std::clamp(part, -1.0, 1.0)) * 180 / std::numbers::pi);
  }
  const double tilt_deg = vernier::internal::median_or_zero(std::move(tilts_deg));
  return tilt_deg > unlikely_deg
             ? fmt::format("the camera is tilted by {:.0f} degrees (median): check --up", tilt_deg)
             : "";
}

NamedFloorPoses all_floor_poses(const FloorPoseOptions& options) {
  NamedFloorPoses all;
  for (const CameraPose& pose : read_poses_of_camera(options.poses).poses) {
    all.names.push_back(pose.image.empty() ? fmt::format("{}", all.names.size() + 1) : pose.image);
    all.poses.push_back(above_floor(pose.T_world_camera, options,
                                    fmt::format("{}: pose {}", options.poses, all.names.back())));
  }
  return all;
}

}  // namespace vernier::cli
