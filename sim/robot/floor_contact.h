// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/visibility/box_tree.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// What stands in the way of a robot: an upright cylinder from 2 cm above the floor to `top_m`. A
/// surface that reaches into this range of heights is in the way with all of its outline, seen from
/// above. Immutable.
class Obstacles {
 public:
  Obstacles(const World& world, double top_m);

  /// Distance on the floor from a point to the nearest outline, but at most `within_m`.
  double distance_m(const Eigen::Vector2d& at_m, double within_m) const;

  /// Where a robot comes that would follow `phases` from `start`, and in which share of their time.
  struct Advance {
    localise::Pose2D pose;
    double time_s = 0;
    bool contact = false;  ///< it touched something and stopped there
  };

  /// By conservative advancement (Mirtich, "Impulse-based dynamic simulation of rigid body
  /// systems", 1996): the robot moves on by as much as it is away from the nearest outline. Contact
  /// is found to 10 µm. One that touches already can move away, along or turn.
  Advance advance(const localise::Pose2D& start,
                  std::span<const DrivePhase> phases,
                  double radius_m) const;

 private:
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> sides_;  // of outlines
  BoxTree tree_;
};

}  // namespace vernier::sim::internal
