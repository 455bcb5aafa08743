// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/simulation/build_input.h"

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/simulation/floor_poses.h"
#include "localise/join/place_segments.h"
#include "localise/joined_lines.h"
#include "localise/place.h"
#include "localise/view_file.h"
#include "localise/views/segments_file.h"

namespace vernier::cli {
namespace {

SeenViews seen_in_segments(const BuildInput& input) {
  const std::vector<SegmentsOfImage> images = read_segments(input.segments);
  SeenViews seen;
  for (const SegmentsOfImage& image : images) seen.images.emplace_back(image.image);
  const std::vector<FloorPose> at = floor_poses(input.at, seen.images);
  for (std::size_t i = 0; i < images.size(); ++i) {
    SegmentsOfView view{at[i].T_floor_camera, {}};
    for (const ImageSegmentInSpace& s : images[i].segments) {
      if (s.reliable) view.segments.push_back(s.in_space);
    }
    seen.segments += view.segments.size();
    seen.T_floor_camera.push_back(view.T_world_camera);
    seen.views.push_back(std::move(view));
  }
  return seen;
}

SeenViews seen_in_features(const BuildInput& input, Session& session) {
  const auto rig =
      input.rig.empty()
          ? nullptr
          : std::make_shared<const Rig>(read_named_rig(input.rig, session).estimate.rig);
  SeenViews seen;
  const std::vector<RecordedLooks> views = read_views(input.features, rig);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!views[i].pose) {
      throw Error(fmt::format("{}: view {}", input.features, i + 1), "has no pose",
                  "give views of known pose");
    }
    for (const Look& look : views[i].looks) {
      const Pose2D pose = compose(*views[i].pose, {0, 0, look.turn_rad});
      seen.views.push_back(segments_of_place(look.view, pose));
      seen.segments += seen.views.back().segments.size();
      const Pose& T_floor_robot = seen.views.back().T_world_camera;
      seen.T_floor_camera.push_back(T_floor_robot * T_robot_camera(look.view.mount));
    }
  }
  return seen;
}

}  // namespace

SeenViews seen_views(const BuildInput& input, Session& session) {
  return input.features.empty() ? seen_in_segments(input) : seen_in_features(input, session);
}

}  // namespace vernier::cli
