// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "calib/rig.h"
#include "datasets/shipped.h"
#include "localise/place.h"
#include "localise/place/view_camera.h"
#include "tests/support/rooms.h"

namespace vernier::test {

inline const std::shared_ptr<const Rig>& shipped_rig() {
  static const auto rig = std::make_shared<const Rig>(datasets::nominal().rig);
  return rig;
}

/// A view with these lines, seen by the shipped rig.
inline PlaceView view_of(std::vector<PlaceLine> lines, double pitch_rad = 0) {
  PlaceView view;
  view.lines = std::move(lines);
  view.rig = shipped_rig();
  view.mount.pitch_rad = pitch_rad;
  return view;
}

/// What both eyes see whole of a room from `pose`.
inline PlaceView camera_view(const std::vector<PlaceLine>& room, const Pose2D& pose = {}) {
  using namespace vernier::localise::internal;
  const ViewCamera camera = view_camera(view_of({}));
  std::vector<PlaceLine> seen;
  for (const PlaceLine& line : seen_from(room, pose)) {
    bool whole = true;
    for (const Eigen::Vector3d& end : {line.a_m, line.b_m}) {
      const Eigen::Vector3f uvw = project(camera, end.cast<float>());
      whole = whole && end.x() > 0.3 && uvw[0] < camera.right_px && uvw[1] > camera.top_px &&
              uvw[1] < camera.bottom_px &&
              uvw[0] - camera.disparity_px_m() * uvw[2] > camera.left_px;
    }
    if (whole) seen.push_back(line);
  }
  return view_of(std::move(seen));
}

}  // namespace vernier::test
