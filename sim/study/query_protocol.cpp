// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/query_protocol.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/route.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace localise;
using namespace vernier::internal;

namespace {

/// Distance on the floor from a point to a segment.
double plan_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double dd = d.squaredNorm();
  const double t = dd > 0 ? std::clamp((p - a).dot(d) / dd, 0.0, 1.0) : 0.0;
  return (a + t * d - p).norm();
}

/// Whether the point is inside the polygon's outline on the floor.
bool inside_plan(const Eigen::Vector2d& p, const std::vector<Eigen::Vector3d>& polygon) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const auto &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      inside = !inside;
    }
  }
  return inside;
}

}  // namespace

std::string_view name(QueryProtocol protocol) {
  switch (protocol) {
    case QueryProtocol::near_path:
      return "near_path";
    case QueryProtocol::path:
      return "path";
    case QueryProtocol::anywhere:
      return "anywhere";
  }
  return "";
}

QueryProtocol query_protocol(std::string_view name_of) {
  for (const auto protocol :
       {QueryProtocol::near_path, QueryProtocol::path, QueryProtocol::anywhere}) {
    if (name(protocol) == name_of) return protocol;
  }
  throw Error("protocol \"" + std::string(name_of) + "\"", "there is no such protocol",
              "use near_path, path or anywhere");
}

ProtocolSpan span(QueryProtocol protocol) {
  constexpr double degree = std::numbers::pi / 180;
  switch (protocol) {
    case QueryProtocol::near_path:
      return {0.1, 5 * degree};
    case QueryProtocol::path:
      return {0.3, 15 * degree};
    case QueryProtocol::anywhere:
      break;
  }
  return {0.6, 180 * degree};
}

bool is_free(const World& world, const Eigen::Vector2d& at_m, double radius_m, double height_m) {
  constexpr double floor_m = 0.02;  // what lies lower is the floor itself
  for (const WorldSurface& surface : world.surfaces) {
    double low = surface.polygon_m[0].z(), high = low;
    for (const auto& point : surface.polygon_m) {
      low = std::min(low, point.z());
      high = std::max(high, point.z());
    }
    if (low > height_m || high < floor_m) continue;
    const auto& polygon = surface.polygon_m;
    if (high - low < 1e-6 && inside_plan(at_m, polygon)) return false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
      if (plan_distance(at_m, polygon[i].head<2>(), polygon[j].head<2>()) < radius_m) return false;
    }
  }
  return true;
}

Pose2D draw_query(const Visibility& visibility,
                  QueryProtocol protocol,
                  double eye_height_m,
                  std::uint64_t seed,
                  std::uint32_t trial) {
  constexpr double robot_radius_m = 0.12;
  const World& world = visibility.world();
  const double length = route_length_m(world.route);
  if (!(length > 0)) {
    throw Error("queries", "the world has no route to ask along", "add [[route]] to the world");
  }
  const ProtocolSpan reach = span(protocol);
  RandomStream draws(
      {.seed = seed, .trial = trial, .source = static_cast<std::uint32_t>(DrawSource::query_pose)});
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const Pose2D on_route = route_point(world.route, draws.uniform(0, length)).pose;
    const double across = draws.uniform(-reach.across_m, reach.across_m);
    const double turn = draws.uniform(-reach.heading_rad, reach.heading_rad);
    const Pose2D query = compose(on_route, {0, across, turn});
    if (!is_free(world, {query.x_m, query.y_m}, robot_radius_m, eye_height_m + 0.2)) continue;
    if (!visibility.sees({on_route.x_m, on_route.y_m, eye_height_m},
                         {query.x_m, query.y_m, eye_height_m})) {
      continue;
    }
    return query;
  }
  throw Error("queries", "no free place near the route in 1000 draws",
              "lead the route through free space");
}

}  // namespace vernier::sim
