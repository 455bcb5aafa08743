// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "cli/program/cli11_fwd.h"
#include "cli/program/namespaces.h"
#include "cli/program/session.h"
#include "localise/place.h"
#include "sim/images/image_scene.h"
#include "sim/images/rendered_pair.h"
#include "sim/visibility.h"

namespace vernier::cli {

/// What the verb render is asked for.
struct RenderArguments {
  std::string world = "workshop", rig = "nominal", output;
  std::vector<std::string> poses;
  int pose_count = 0;
  std::string protocol = "path";
  double height_m = 1.2, pitch_deg = 0;
  std::uint64_t seed = 1;
  bool no_noise = false, no_lamps = false, compare = false;
  ImageSceneOptions scene;
  PairOptions pair;
};

void add_render_options(CLI::App& verb, RenderArguments& arguments);

/// Poses to render from, and which trial of a study each is a query of (-1: none).
struct RenderPoses {
  std::vector<Pose2D> poses;
  std::vector<int> trials;
  int left_out = 0;  ///< queries where a surface stands between the eyes
};

/// Pose of the left camera of the robot at a pose.
Pose left_camera(const RenderArguments& arguments, const Pose2D& pose);

/// The poses given, or those of the first queries of a study of this seed, without those where a
/// surface stands between the eyes: places of queries are free for the left camera only. Throws
/// Error for a pose given at which no robot can stand, or where its eyes are so separated.
RenderPoses poses_of(const RenderArguments& arguments,
                     const Visibility& visibility,
                     const Rig& rig);

/// All options that change an image.
Json settings_json(const RenderArguments& arguments);

}  // namespace vernier::cli
