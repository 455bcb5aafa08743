// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/routing/closed_bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"

namespace vernier::sim::internal {

namespace {

/// Whether a polygon, seen along an axis, lies around a point (even-odd rule).
bool surrounds(const std::vector<Eigen::Vector3d>& polygon, const Eigen::Vector3d& at, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  bool is_inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a[v] > at[v]) == (b[v] > at[v])) continue;
    if (at[u] < a[u] + (at[v] - a[v]) / (b[v] - a[v]) * (b[u] - a[u])) is_inside = !is_inside;
  }
  return is_inside;
}

}  // namespace

ClosedBodies::ClosedBodies(const World& world) {
  for (const WorldSurface& surface : world.surfaces) {
    const PolygonPlane plane = polygon_plane(surface.polygon_m);
    if (plane.normal.isZero()) continue;
    Face face{plane.normal, surface.polygon_m[0], surface.polygon_m[0], plane.distance_m,
              &surface.polygon_m};
    for (const Eigen::Vector3d& p : surface.polygon_m) {
      face.low_m = face.low_m.cwiseMin(p);
      face.high_m = face.high_m.cwiseMax(p);
    }
    faces_.push_back(face);
  }
}

int ClosedBodies::seen_along(const Eigen::Vector3d& at_m, int axis, double sign) const {
  constexpr double parallel = 0.05, same_m = 2e-3;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<std::pair<double, bool>> seen;  // how far, and whether from behind
  for (const Face& face : faces_) {
    if (at_m[u] < face.low_m[u] || at_m[u] > face.high_m[u] || at_m[v] < face.low_m[v] ||
        at_m[v] > face.high_m[v] || std::abs(face.normal[axis]) < parallel) {
      continue;
    }
    const double far = sign * (face.distance_m - face.normal.dot(at_m)) / face.normal[axis];
    if (far <= 0 || !surrounds(*face.polygon_m, at_m, axis)) continue;
    seen.emplace_back(far, sign * face.normal[axis] > 0);
  }
  std::sort(seen.begin(), seen.end());
  for (std::size_t i = 0; i < seen.size();) {
    std::array<bool, 2> sides{};
    const double here = seen[i].first;
    for (; i < seen.size() && seen[i].first - here < same_m; ++i) sides[seen[i].second] = true;
    if (sides[0] != sides[1]) return sides[1] ? 1 : -1;
  }
  return 0;
}

bool ClosedBodies::contain(const Eigen::Vector3d& at_m) const {
  constexpr int least = 3;
  int behind = 0;
  for (const auto& [axis, sign] : {std::pair(0, 1.0), {0, -1.0}, {1, 1.0}, {1, -1.0}, {2, 1.0}}) {
    const int seen = seen_along(at_m, axis, sign);
    if (seen < 0) return false;
    behind += seen;
  }
  return behind >= least;
}

}  // namespace vernier::sim::internal
