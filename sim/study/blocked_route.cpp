// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/blocked_route.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/study/free_floor.h"
#include "sim/study/standing_place.h"
#include "sim/world.h"

namespace vernier::sim::internal {
namespace {

constexpr double place_step_m = 0.1;
constexpr int most_places = 5'000;  // of a longer route, fewer a metre

std::vector<Eigen::Vector2d> places_of(const World& world) {
  std::vector<Eigen::Vector2d> places;
  const double length_m = route_length_m(world.route);
  if (!(length_m > 0)) return places;
  const int steps = std::min(most_places, 1 + static_cast<int>(length_m / place_step_m));
  for (int i = 0; i <= steps; ++i) {
    const auto at = route_point(world.route, length_m * i / steps).pose;
    places.emplace_back(at.x_m, at.y_m);
  }
  return places;
}

int free_ones(const World& world, const std::vector<Eigen::Vector2d>& places, double eye_height_m) {
  const Standing standing(world, eye_height_m);
  return static_cast<int>(std::count_if(places.begin(), places.end(),
                                        [&](const auto& at) { return standing.is_free(at); }));
}

}  // namespace

BlockedRoute blocked_route(const World& world, double eye_height_m) {
  constexpr double low_m = 0.3;
  const std::vector<Eigen::Vector2d> places = places_of(world);
  BlockedRoute route;
  route.places = static_cast<int>(places.size());
  const Standing standing(world, eye_height_m);
  for (const Eigen::Vector2d& at : places) {
    if (standing.is_free(at)) continue;
    if (route.blocked++ == 0) route.first_m = at;
  }
  route.is_too_high = route.places > 0 && route.blocked == route.places && eye_height_m > low_m &&
                      2 * free_ones(world, places, low_m) >= route.places;
  return route;
}

RouteFault route_fault(const World& world, double eye_height_m) {
  const BlockedRoute route = blocked_route(world, eye_height_m);
  if (route.blocked == 0) return {};
  if (route.is_too_high) {
    return {fmt::format("passes under what is lower than {:g} m everywhere, {:g} m above a camera "
                        "at {:g} m",
                        eye_height_m + robot_top_m, robot_top_m, eye_height_m),
            "lower the camera", route.share()};
  }
  return {
      fmt::format("leads through something in {:.2g} % of its length, first at ({:.2f}, {:.2f}) "
                  "m: a robot of {:g} m radius cannot stand there",
                  100 * route.share(), route.first_m.x(), route.first_m.y(), robot_radius_m),
      "move the route (vernier world route proposes one)", route.share()};
}

}  // namespace vernier::sim::internal
