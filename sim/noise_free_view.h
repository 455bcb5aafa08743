// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/visibility.h"

namespace vernier::sim {

/// VisibleEdge::segment of an edge that the world does not have: a false one (source `clutter`).
inline constexpr int no_segment = -1;

/// An edge visible in both cameras, without error: ends in the true left camera frame.
struct VisibleEdge {
  Eigen::Vector3d a_m, b_m;
  int segment = 0;            ///< index in the world, or no_segment
  std::uint32_t feature = 0;  ///< segment and visible run; key of its random draws
  std::int32_t object = 0;
  Eigen::Vector3d object_centre_m;  ///< true left camera frame

  bool is_false() const { return segment == no_segment; }
};

/// A corner visible in both cameras.
struct VisibleCorner {
  Eigen::Vector3d at_m;       ///< true left camera frame
  std::uint32_t feature = 0;  ///< index of the world's corner
};

/// The noise-free view from one pose, which all error sources act on.
struct NoiseFreeView {
  localise::Pose2D pose;
  std::vector<VisibleEdge> edges;
  std::vector<VisibleCorner> corners;
};

struct NoiseFreeViewOptions {
  localise::CameraMount mount;
  double roll_rad = 0;  ///< of the camera, about its optical axis: clockwise as seen from behind
  VisibilityOptions visibility;
  bool with_corners = false;
};

/// Pose of the left camera of a robot at `pose`.
Pose T_left_world(const localise::Pose2D& pose,
                  const localise::CameraMount& mount,
                  double roll_rad = 0);

/// The runs of edges visible in both cameras of the true rig, at least min_length_px long in the
/// left image. Throws Error unless the rig has two cameras.
NoiseFreeView look(const Visibility& visibility,
                   const Rig& rig,
                   const localise::Pose2D& pose,
                   const NoiseFreeViewOptions& options = {});

}  // namespace vernier::sim
