// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/place.h"
#include "sim/world.h"

namespace vernier::sim {

/// A point of a route and the direction of travel.
struct RoutePoint {
  localise::Pose2D pose;
  double leg_position_m = 0;  ///< from the start of its leg
  int leg = 0;
};

/// Total length of all legs, metres.
double route_length_m(const std::vector<RouteLeg>& route);

/// The point at `s_m` metres along all legs in sequence (clamped to the ends of the route).
RoutePoint route_point(const std::vector<RouteLeg>& route, double s_m);

/// Poses at which a map is recorded: every leg is divided evenly into steps of at most `spacing_m`,
/// including its start but not its end. With `headings` = 0 one per position, facing along the
/// route; else that many all around. Throws Error for an empty route or spacing <= 0.
std::vector<localise::Pose2D> map_poses(const std::vector<RouteLeg>& route,
                                        double spacing_m,
                                        int headings = 0);

}  // namespace vernier::sim
