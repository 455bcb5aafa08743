// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/blocked_route.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "calib/error.h"
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

std::vector<Eigen::Vector2d> blocked_ones(const World& world,
                                          const std::vector<Eigen::Vector2d>& places,
                                          double eye_height_m) {
  const Standing standing(world, eye_height_m);
  std::vector<Eigen::Vector2d> blocked;
  std::copy_if(places.begin(), places.end(), std::back_inserter(blocked),
               [&](const Eigen::Vector2d& at) { return !standing.is_free(at); });
  return blocked;
}

/// Infinite of an empty world.
double lowest_point_m(const World& world) {
  double low =
      world.segments.empty() ? std::numeric_limits<double>::infinity() : extent(world).low_m.z();
  for (const WorldSurface& surface : world.surfaces) {
    for (const Eigen::Vector3d& point : surface.polygon_m) low = std::min(low, point.z());
  }
  return low;
}

/// Of a world that lies above robots, which is no building for them, or so far above the floor that
/// they can stand hardly anywhere.
RouteFault floor_fault(const World& world, double blocked, double eye_height_m) {
  constexpr double on_floor_m = 0.02, nearly_all = 0.99;
  const double low_m = lowest_point_m(world);
  const bool is_above = low_m > eye_height_m + robot_top_m;
  if (std::isinf(low_m) || !(is_above || (low_m > on_floor_m && blocked > nearly_all))) return {};
  return {fmt::format("lies below all of the world, which begins at z = {:.3g} m, and robots drive "
                      "at z = 0",
                      low_m),
          "if that is its floor, shift the world down", 1};
}

}  // namespace

BlockedRoute blocked_route(const World& world, double eye_height_m) {
  constexpr double low_m = 0.3;
  const std::vector<Eigen::Vector2d> places = places_of(world);
  const std::vector<Eigen::Vector2d> blocked = blocked_ones(world, places, eye_height_m);
  BlockedRoute route;
  route.places = static_cast<int>(places.size());
  route.blocked = static_cast<int>(blocked.size());
  if (blocked.empty()) return route;
  route.first_m = blocked[0];
  route.is_too_high = route.blocked == route.places && eye_height_m > low_m &&
                      2 * blocked_ones(world, places, low_m).size() <= places.size();
  return route;
}

RouteFault route_fault(const World& world, double eye_height_m) {
  const BlockedRoute route = blocked_route(world, eye_height_m);
  if (route.places == 0) return {};
  if (RouteFault fault = floor_fault(world, route.share(), eye_height_m); !fault.fault.empty())
    return fault;
  if (route.blocked == 0) return {};
  if (route.is_too_high) {
    return {fmt::format("passes under what is lower than {:g} m everywhere, {:g} m above a camera "
                        "at {:g} m",
                        eye_height_m + robot_top_m, robot_top_m, eye_height_m),
            "lower the camera", route.share()};
  }
  return {
      fmt::format("leads through something in {:.3g} % of its length, first at ({:.2f}, {:.2f}) "
                  "m: a robot of {:g} m radius cannot stand there",
                  100 * route.share(), route.first_m.x(), route.first_m.y(), robot_radius_m),
      "move the route (vernier world route proposes one)", route.share()};
}

void throw_no_free_position(const World& world, double eye_height_m) {
  constexpr double cause = 0.99;  // share of the route: 1000 draws find a hundredth that is free
  const RouteFault route = route_fault(world, eye_height_m);
  const std::string fault = "no free position near the route in 1000 draws";
  if (route.share < cause) throw Error("queries", fault, "move the route through free space");
  throw Error("queries", fault + ": it " + route.fault, route.remedy);
}

}  // namespace vernier::sim::internal
