// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/wire_shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {
namespace {

using Eigen::Vector3d;

constexpr double grid_steps = 1e4;

std::array<std::int64_t, 3> grid_point(const Vector3d& x) {
  return {std::llround(x.x() * grid_steps), std::llround(x.y() * grid_steps),
          std::llround(x.z() * grid_steps)};
}

}  // namespace

double to_grid(double value_m) {
  // Adding zero turns -0 into 0.
  return static_cast<double>(std::llround(value_m * grid_steps)) / grid_steps + 0.0;
}

Vector3d to_grid(const Vector3d& value_m) {
  return {to_grid(value_m.x()), to_grid(value_m.y()), to_grid(value_m.z())};
}

Vector3d QuarterFrame::operator*(const Vector3d& x) const {
  switch (quarters & 3) {
    case 0:
      return origin_m + x;
    case 1:
      return origin_m + Vector3d(-x.y(), x.x(), x.z());
    case 2:
      return origin_m + Vector3d(-x.x(), -x.y(), x.z());
    default:
      return origin_m + Vector3d(x.y(), -x.x(), x.z());
  }
}

Eigen::AlignedBox3d QuarterFrame::operator*(const Eigen::AlignedBox3d& box) const {
  Eigen::AlignedBox3d placed;
  placed.extend(*this * box.min());
  placed.extend(*this * box.max());
  return placed;
}

void Shapes::line(const Vector3d& a_m, const Vector3d& b_m) {
  const Vector3d a = to_grid(frame * a_m), b = to_grid(frame * b_m);
  std::array<GridPoint, 2> key{grid_point(a), grid_point(b)};
  std::sort(key.begin(), key.end());
  if (seen_.insert(key).second) features_.segments_m.emplace_back(a, b);
}

void Shapes::upright_rectangle(double x0_m, double z0_m, double x1_m, double z1_m, double y_m) {
  line({x0_m, y_m, z0_m}, {x1_m, y_m, z0_m});
  line({x1_m, y_m, z0_m}, {x1_m, y_m, z1_m});
  line({x1_m, y_m, z1_m}, {x0_m, y_m, z1_m});
  line({x0_m, y_m, z1_m}, {x0_m, y_m, z0_m});
}

void Shapes::level_rectangle(double x0_m, double y0_m, double x1_m, double y1_m, double z_m) {
  line({x0_m, y0_m, z_m}, {x1_m, y0_m, z_m});
  line({x1_m, y0_m, z_m}, {x1_m, y1_m, z_m});
  line({x1_m, y1_m, z_m}, {x0_m, y1_m, z_m});
  line({x0_m, y1_m, z_m}, {x0_m, y0_m, z_m});
}

void Shapes::box(const Vector3d& low_m, const Vector3d& high_m, unsigned faces) {
  leg(low_m, high_m, faces);
  level_rectangle(low_m.x(), low_m.y(), high_m.x(), high_m.y(), high_m.z());
}

void Shapes::leg(const Vector3d& low_m, const Vector3d& high_m, unsigned faces) {
  level_rectangle(low_m.x(), low_m.y(), high_m.x(), high_m.y(), low_m.z());
  for (const double x : {low_m.x(), high_m.x()}) {
    for (const double y : {low_m.y(), high_m.y()}) line({x, y, low_m.z()}, {x, y, high_m.z()});
  }
  surfaces_of_box(low_m, high_m, faces);
}

void Shapes::surfaces_of_box(const Vector3d& low_m, const Vector3d& high_m, unsigned faces) {
  static constexpr std::array<BoxFaces, 6> every{left_face,  right_face,  back_face,
                                                 front_face, bottom_face, top_face};
  for (int side = 0; side < 6; ++side) {
    if (!(faces & every[side])) continue;
    const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    Vector3d corner = side % 2 ? high_m : low_m;
    std::vector<Vector3d> polygon;
    for (int i = 0; i < 4; ++i) {
      corner[u] = i == 1 || i == 2 ? high_m[u] : low_m[u];
      corner[v] = i >= 2 ? high_m[v] : low_m[v];
      polygon.push_back(to_grid(frame * corner));
    }
    features_.surfaces_m.push_back(std::move(polygon));
  }
}

FeatureSet Shapes::features() const {
  FeatureSet result = features_;
  // The first direction at every end point, in the order of the segments.
  std::map<GridPoint, Vector3d> direction_at;
  std::set<GridPoint> corners;
  for (const auto& [a, b] : features_.segments_m) {
    const Vector3d direction = (b - a).normalized();
    for (const Vector3d& end : {a, b}) {
      const GridPoint key = grid_point(end);
      const auto [first, is_new] = direction_at.emplace(key, direction);
      // Two directions within half a degree do not form a corner.
      if (is_new || first->second.cross(direction).norm() < 0.01) continue;
      if (corners.insert(key).second) result.corners_m.push_back(end);
    }
  }
  return result;
}

Eigen::AlignedBox3d bounds(const FeatureSet& features) {
  Eigen::AlignedBox3d box;
  for (const auto& [a, b] : features.segments_m) {
    box.extend(a);
    box.extend(b);
  }
  return box;
}

}  // namespace vernier::sim::internal
