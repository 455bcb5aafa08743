// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/pose.h"

namespace vernier::localise::internal {

/// Where a camera, or what carries it, was: by the name of an image, by time, or by order.
struct CameraPose {
  std::string image;             ///< as the file names it; empty if not named
  std::optional<double> time_s;  ///< seconds; empty if not known
  Pose T_world_camera;
};

struct CameraPoses {
  std::vector<CameraPose> poses;
  bool of_body = false;  ///< they are T_world_body: each still lacks T_body_camera
};

/// Reads poses of a camera, in whichever format the content shows:
///
///  - TUM's and KITTI's trajectories (localise/trajectory.h);
///  - ASL's ground truth, as EuRoC has it (Burri et al., IJRR 2016): lines of
///    `timestamp_ns, x, y, z, qw, qx, qy, qz, …` below a header that begins with #, poses of the
///    body, whose further columns are ignored;
///  - a table with the header `frame,t00,t01 … t33` (or `image,…`): 4 x 4 matrices by rows, camera
///    to world, each with the name of its image;
///  - COLMAP's images.txt or the folder of it: world to camera, turned round here.
///
/// Positions are in metres. Throws Error with file and line.
CameraPoses read_camera_poses(const std::filesystem::path& file_or_folder);

/// The same where a pose of the body is of no use: throws Error for poses of one too.
CameraPoses read_poses_of_camera(const std::filesystem::path& file_or_folder);

/// The time in the name of an image without its ending: seconds, or, from 16 digits on, nanoseconds
/// as ASL has them.
std::optional<double> time_of_name(const std::string& stem);

/// The poses of images, given by name, in their order. Named poses are found by the image's name
/// (names_of_images). Where images are named after their times (seconds, or nanoseconds as
/// ASL has them) and poses have times, a pose is interpolated between the two around (positions
/// linearly, rotations along the shortest arc); it must lie between two that are at most `gap_s`
/// apart. Else poses belong to images in order, and there must be as many. Throws Error(`place`).
std::vector<Pose> poses_of_images(const CameraPoses& poses,
                                  const std::vector<std::filesystem::path>& images,
                                  const std::string& place,
                                  double gap_s = 0.5);

}  // namespace vernier::localise::internal
