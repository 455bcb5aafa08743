// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/backing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "sim/visibility/box_tree.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

namespace {

constexpr double on_line_m = 1e-3, same_distance_m = 2e-3;

/// Length of a segment that runs along one from p to q, to 1 mm.
double along_border(const Vector3d& a, const Vector3d& b, const Vector3d& p, const Vector3d& q) {
  const double length = (q - p).norm();
  if (!(length > 0)) return 0;
  const Vector3d d = (q - p) / length;
  for (const Vector3d* x : {&a, &b}) {
    const Vector3d from = *x - p;
    if ((from - from.dot(d) * d).norm() > on_line_m) return 0;
  }
  const auto [low, high] = std::minmax({(a - p).dot(d), (b - p).dot(d)});
  return std::min(high, length) - std::max(low, 0.0);
}

/// Whether a point projects into a polygon along the axis of its normal's largest component.
bool is_over(const Vector3d& x, const std::vector<Vector3d>& polygon, const Vector3d& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return inside_outline(x, polygon, axis);
}

AlignedBox3d box_of(const std::vector<Vector3d>& points) {
  AlignedBox3d box;
  for (const Vector3d& x : points) box.extend(x);
  return box;
}

AlignedBox3d grown(const AlignedBox3d& box, double by_m) {
  const Vector3d margin = Vector3d::Constant(by_m);
  return {box.min() - margin, box.max() + margin};
}

}  // namespace

Backing::Backing(const World& world) : world_(world) {
  std::vector<AlignedBox3d> boxes;
  boxes.reserve(world.surfaces.size());
  for (const WorldSurface& surface : world.surfaces) {
    planes_.push_back(polygon_plane(surface.polygon_m));
    boxes.push_back(box_of(surface.polygon_m));
  }
  tree_ = BoxTree(std::move(boxes));
}

bool Backing::borders(const Vector3d& a, const Vector3d& b) const {
  const AlignedBox3d place = grown(box_of({a, b}), on_line_m);
  const double half = (b - a).norm() / 2;
  bool found = false;
  tree_.visit([&](const AlignedBox3d& box) { return box.intersects(place); },
              [&](int i) {
                const std::vector<Vector3d>& p =
                    world_.surfaces[static_cast<std::size_t>(i)].polygon_m;
                for (std::size_t k = 0, last = p.size() - 1; k < p.size() && !found; last = k++) {
                  found = along_border(a, b, p[last], p[k]) >= half;
                }
                return found;
              });
  return found;
}

std::optional<Vector3d> Backing::behind(const std::vector<Vector3d>& points, double reach_m) const {
  const AlignedBox3d place = grown(box_of(points), reach_m);
  double nearest = reach_m;
  int best = -1;
  std::vector<int> near;
  tree_.find([&](const AlignedBox3d& box) { return box.intersects(place); }, near);
  for (const int i : near) {
    const auto number = static_cast<std::size_t>(i);
    const PolygonPlane& plane = planes_[number];
    if (plane.normal.isZero()) continue;
    double low = reach_m + 1, high = -low;
    bool over = true;
    for (const Vector3d& x : points) {
      const double off = plane.normal.dot(x) - plane.distance_m;
      low = std::min(low, off);
      high = std::max(high, off);
      over = over && is_over(x, world_.surfaces[number].polygon_m, plane.normal);
    }
    const double distance = std::max(std::abs(low), std::abs(high));
    if (!over || high - low > same_distance_m || distance > nearest) continue;
    nearest = distance;
    best = i;
  }
  if (best < 0) return std::nullopt;
  return planes_[static_cast<std::size_t>(best)].normal;
}

}  // namespace vernier::sim::internal
