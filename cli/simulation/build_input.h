// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "cli/simulation/floor_poses.h"
#include "localise/joined_lines.h"

namespace vernier::cli {

/// Segments in space of images with a file of poses, or views that have their poses: one of both.
struct BuildInput {
  std::string segments, features;
  FloorPoseOptions at;  ///< of the images of `segments`
  std::string rig;      ///< of `features` that name none, and of depth maps
};

/// What was seen, in the frame of the floor.
struct SeenViews {
  std::vector<SegmentsOfView> views;
  std::vector<Pose> T_floor_camera;
  std::vector<std::filesystem::path> images;  ///< names of the views' images, if of `segments`
  std::size_t segments = 0;
};

/// Throws Error with file and line, and for views without a pose.
SeenViews seen_views(const BuildInput& input, Session& session);

}  // namespace vernier::cli
