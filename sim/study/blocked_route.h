// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "sim/world.h"

namespace vernier::sim::internal {

/// Places of a route, every 0.1 m, where a robot cannot stand (Standing).
struct BlockedRoute {
  int places = 0, blocked = 0;
  Eigen::Vector2d first_m{0, 0};  ///< the first blocked one
  bool is_too_high = false;       ///< all are blocked, and half of them not for a camera 0.3 m high

  double share() const { return places > 0 ? static_cast<double>(blocked) / places : 0; }
};

/// For a robot whose camera is at a height. No places in a world without a route.
BlockedRoute blocked_route(const World& world, double eye_height_m);

/// What keeps a robot from the route, as a predicate for a sentence about the route, and what to
/// do; both are empty if nothing does.
struct RouteFault {
  std::string fault, remedy;
  double share = 0;  ///< of the route's places
};
RouteFault route_fault(const World& world, double eye_height_m);

/// Throws the Error of queries that are drawn near a route without a free place, with its fault if
/// that concerns nearly all of the route.
[[noreturn]] void throw_no_free_position(const World& world, double eye_height_m);

}  // namespace vernier::sim::internal
