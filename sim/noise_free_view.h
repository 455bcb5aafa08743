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

/// An edge that both eyes see, without any error: ends in the true left camera's frame.
struct VisibleEdge {
  Eigen::Vector3d a_m, b_m;
  int segment = 0;            ///< of the world
  std::uint32_t feature = 0;  ///< segment and visible run; identity for draws
  std::int32_t object = 0;
  Eigen::Vector3d object_centre_m;  ///< true left camera's frame
};

/// A corner that both eyes see.
struct VisibleCorner {
  Eigen::Vector3d at_m;       ///< true left camera's frame
  std::uint32_t feature = 0;  ///< the world's corner
};

/// What there is to see from one pose: the noise-free view that all sources act on.
struct NoiseFreeView {
  localise::Pose2D pose;
  std::vector<VisibleEdge> edges;
  std::vector<VisibleCorner> corners;
};

struct NoiseFreeViewOptions {
  localise::CameraMount mount;
  VisibilityOptions visibility;
  bool with_corners = false;
};

/// Pose of the left camera for a robot standing at `pose`.
Pose T_left_world(const localise::Pose2D& pose, const localise::CameraMount& mount);

/// Edges in the stretches that both cameras of the true rig see, at least min_length_px long in
/// the left image. Throws Error unless the rig is a pair.
NoiseFreeView look(const Visibility& visibility,
                   const Rig& rig,
                   const localise::Pose2D& pose,
                   const NoiseFreeViewOptions& options = {});

}  // namespace vernier::sim
