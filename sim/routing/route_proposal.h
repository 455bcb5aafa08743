// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sim/routing/floor_plan.h"
#include "sim/world.h"

namespace vernier::sim::internal {

struct RouteProposal {
  std::vector<RouteLeg> route;
  double floor_m2 = 0;        ///< inside, free for a robot
  double near_m2 = 0;         ///< of it within 2 m of the route, on the way of a robot
  double other_m2 = 0;        ///< beside it, to which the robot has no way: behind closed doors
  double level_m2 = 0;        ///< beside it, at another level: lower, a hole, or a step higher
  double open_m2 = 0;         ///< beside it, left out since it is open to the surroundings
  bool is_cut_short = false;  ///< it has as many legs as a route may have, and parts are left
  bool is_open = false;       ///< the floor of the route is open to the surroundings
  double gap_m = 0;           ///< by a gap about so wide; 0: there are no walls around
};

/// A route that leads through all of a free floor that is inside: the longest way first, then a leg
/// into every part that is further than 2.5 m of way from what there is, the furthest first. Ways
/// prefer to keep 0.5 m from what stands there. The route is empty where no floor is, and no walls
/// around, and has `most_legs` at most.
RouteProposal propose_route(const FloorPlan& plan, std::size_t most_legs = 1000);

}  // namespace vernier::sim::internal
