// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/floor_poses.h"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

#include "calib/error.h"
#include "calib/pose.h"
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

std::vector<FloorPose> floor_poses(const FloorPoseOptions& options,
                                   const std::vector<std::filesystem::path>& images) {
  const CameraPoses read = read_camera_poses(options.poses);
  if (read.of_body) {
    throw Error(options.poses, "holds poses of the body, not of the camera",
                "give those of the camera");
  }
  const auto [axis, sign] = up_axis(options.up);
  const std::vector<Pose> poses = poses_of_images(read, images, options.poses);
  std::vector<FloorPose> all;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    FloorPose pose{level_pose(poses[i], axis, sign, images[i].string()), {}};
    LevelPose& level = pose.level;
    level.height_m += options.height_m;
    if (!(level.height_m > 0)) {
      throw Error(images[i].string(),
                  fmt::format("its camera is {:.2f} m above the floor", level.height_m),
                  "give the height of the poses' origin above the floor, --height-m, and --up");
    }
    const Eigen::Matrix3d R_floor_robot = rotation_from_vector({0, 0, level.pose.heading_rad});
    pose.T_floor_camera = {R_floor_robot * T_robot_camera({}).R * level.R_level_camera,
                           {level.pose.x_m, level.pose.y_m, level.height_m}};
    all.push_back(std::move(pose));
  }
  return all;
}

}  // namespace vernier::cli
