// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "calib/rig_estimate.h"
#include "localise/place.h"
#include "sim/robot.h"
#include "sim/servo/goal_alignment.h"
#include "sim/visibility.h"
#include "sim/visual_servo.h"

namespace vernier::sim::internal {

/// Which object the robot should stand in front of, and where.
struct ServoPlace {
  const Visibility& visibility;
  const RigEstimate& rig;
  int door;  ///< object of the world
  localise::Pose2D goal;
};

struct ServoDraw {
  std::uint64_t seed;
  std::uint32_t trial;
};

/// The lines of the door as the robot should see them. Which lines are the door's is told here, as
/// by someone who marks them in the view, and never again. Lines shorter than 60 px, near the
/// epipolar direction, or within 6 px of a longer one are left out. A source that fails is told in
/// `failure`. Draws of a recorded view: counter (trial 2^31 + trial, frame 0); of a taught one, the
/// last frame of the trial, which no drive reaches.
DesiredView desired_view(const Robot& robot,
                         const ServoPlace& place,
                         ServoGoal kind,
                         const ServoDraw& draw,
                         std::string& failure);

}  // namespace vernier::sim::internal
