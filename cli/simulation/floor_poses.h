// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "cli/program/namespaces.h"
#include "localise/views/camera_poses.h"
#include "localise/views/depth_view.h"

namespace vernier::cli {

/// Poses of a camera that a file gives in a world of its own.
struct FloorPoseOptions {
  std::string poses, up = "z";
  double height_m = 1.2;  ///< of the origin of their world above the floor
};

/// A camera above the floor: the frame of the floor has z up, the floor at 0, and the poses' origin
/// above its own.
struct FloorPose {
  LevelPose level;  ///< its height from the floor
  Pose T_floor_camera;
};

/// The axis that points up in the world of the poses, and its sign. Throws Error(--up).
std::pair<int, int> up_axis(const std::string& word);

/// The poses of images, in their order. Throws Error for poses of a body, without an image's, of a
/// camera that looks straight up or down, and of one that is below the floor.
std::vector<FloorPose> floor_poses(const FloorPoseOptions& options,
                                   const std::vector<std::filesystem::path>& images);
/// The same of poses that were read from options.poses.
std::vector<FloorPose> floor_poses(const CameraPoses& poses,
                                   const FloorPoseOptions& options,
                                   const std::vector<std::filesystem::path>& images);

/// What to say of cameras that are mostly held as none is; empty if there is nothing to say. `down`
/// are the parts of their y axes that point to the floor: 1 of a level camera.
std::string tilt_doubt(const std::vector<double>& down);

/// All poses of the file in its order, with their images' names, or numbers from 1.
struct NamedFloorPoses {
  std::vector<std::string> names;
  std::vector<FloorPose> poses;
};
NamedFloorPoses all_floor_poses(const FloorPoseOptions& options);

}  // namespace vernier::cli
