// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/routing/floor_plan.h"
#include "sim/world.h"

namespace vernier::sim::internal {

struct RouteProposal {
  std::vector<RouteLeg> route;
  double floor_m2 = 0;   ///< inside, free for a robot
  double near_m2 = 0;    ///< of it within 2 m of the route, on the way of a robot
  double other_m2 = 0;   ///< beside it, to which the robot has no way: behind closed doors
  bool is_open = false;  ///< no floor is enclosed; the route is on what is open to the surroundings
  double gap_m = 0;      ///< by a gap about so wide; 0: there are no walls around
};

/// A route that leads through all of a free floor that is inside: the longest way first, then a leg
/// into every part that is further than 2.5 m of way from what there is, the furthest first. Ways
/// prefer to keep 0.5 m from what stands there. Without any floor for a robot the route is empty.
RouteProposal propose_route(const FloorPlan& plan);

}  // namespace vernier::sim::internal
