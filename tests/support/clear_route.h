// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "sim/world.h"

namespace vernier::test {

using namespace vernier::sim;
using Eigen::Vector2d;
using Eigen::Vector3d;

inline double distance_to_line(const Vector2d& x, const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  const double t = std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (x - a - t * d).norm();
}

inline double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

inline bool cut(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 &&
         cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

inline double clearance(const Vector2d& a, const Vector2d& b, const WorldSurface& surface) {
  double nearest = 1e9;
  const auto& polygon = surface.polygon_m;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d c = polygon[i].head<2>(), d = polygon[(i + 1) % polygon.size()].head<2>();
    if (cut(a, b, c, d)) return 0;
    nearest = std::min({nearest, distance_to_line(c, a, b)});
    if ((d - c).norm() > 0)
      nearest = std::min({nearest, distance_to_line(a, c, d), distance_to_line(b, c, d)});
  }
  return nearest;
}

inline bool is_floor(const WorldSurface& surface) {
  return std::all_of(surface.polygon_m.begin(), surface.polygon_m.end(),
                     [](const Vector3d& x) { return x.z() == 0; });
}

inline double lowest(const WorldSurface& surface) {
  double z = 1e9;
  for (const auto& point : surface.polygon_m) z = std::min(z, point.z());
  return z;
}

/// Whether the route of a world keeps 0.3 m from everything below 1.4 m.
inline void expect_clear_route(const World& world) {
  for (const auto& leg : world.route) {
    for (std::size_t i = 0; i + 1 < leg.points_m.size(); ++i) {
      for (const auto& surface : world.surfaces) {
        if (is_floor(surface) || lowest(surface) >= 1.4) continue;
        ASSERT_GE(clearance(leg.points_m[i], leg.points_m[i + 1], surface), 0.3)
            << world.objects[surface.object].template_name << " near "
            << surface.polygon_m[0].transpose();
      }
    }
  }
}

/// Whether two lines on the floor meet, or come as near as the wall between two parts is thick.
inline bool meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  constexpr double near_m = 0.15;
  return cut(a, b, c, d) ||
         std::min({distance_to_line(a, c, d), distance_to_line(b, c, d), distance_to_line(c, a, b),
                   distance_to_line(d, a, b)}) < near_m;
}

inline bool meet(const RouteLeg& one, const RouteLeg& other) {
  for (std::size_t i = 0; i + 1 < one.points_m.size(); ++i) {
    for (std::size_t k = 0; k + 1 < other.points_m.size(); ++k) {
      if (meet(one.points_m[i], one.points_m[i + 1], other.points_m[k], other.points_m[k + 1])) {
        return true;
      }
    }
  }
  return false;
}

/// Number of parts of a route of which no leg meets one of another.
inline int connected_parts(const std::vector<RouteLeg>& route) {
  std::vector<bool> reached(route.size());
  int parts = 0;
  for (std::size_t start = 0; start < route.size(); ++start) {
    if (reached[start]) continue;
    ++parts;
    std::vector<std::size_t> open{start};
    reached[start] = true;
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      for (std::size_t next = 0; next < route.size(); ++next) {
        if (reached[next] || !meet(route[at], route[next])) continue;
        reached[next] = true;
        open.push_back(next);
      }
    }
  }
  return parts;
}

}  // namespace vernier::test
