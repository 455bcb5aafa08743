// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/building_site.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "calib/statistics/random.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"
#include "sim/world/plan_distance.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double route_clearance_m = 0.35;  ///< the documented minimum is 0.3 m
constexpr double headroom_m = 2.0;
constexpr double site_gap_m = 0.015;  ///< between neighbours, so that edges never coincide

bool crosses(const Eigen::AlignedBox2d& box, const Vector2d& a, const Vector2d& b) {
  double first = 0, last = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double d = b[axis] - a[axis];
    if (d == 0) {
      if (a[axis] < box.min()[axis] || a[axis] > box.max()[axis]) return false;
      continue;
    }
    const double t0 = (box.min()[axis] - a[axis]) / d, t1 = (box.max()[axis] - a[axis]) / d;
    first = std::max(first, std::min(t0, t1));
    last = std::min(last, std::max(t0, t1));
  }
  return first <= last;
}

}  // namespace

double distance_to_path(const AlignedBox3d& box, const FloorPath& path_m) {
  const Eigen::AlignedBox2d plan(box.min().head<2>(), box.max().head<2>());
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < path_m.size(); ++i) {
    const Vector2d& a = path_m[i];
    const Vector2d& b = path_m[i + 1];
    if (crosses(plan, a, b)) return 0;
    // The closest points of two disjoint convex shapes include a vertex of one of them.
    nearest = std::min({nearest, plan.exteriorDistance(a), plan.exteriorDistance(b)});
    for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight,
                              Eigen::AlignedBox2d::TopLeft, Eigen::AlignedBox2d::TopRight}) {
      nearest = std::min(nearest, plan_distance(plan.corner(corner), a, b));
    }
  }
  return nearest;
}

RoomWall RectangularRoom::wall(int side) const {
  const double width = high_m.x() - low_m.x(), depth = high_m.y() - low_m.y();
  switch (side) {
    case 0:
      return {{{low_m.x(), low_m.y(), 0}, 0}, width};
    case 1:
      return {{{high_m.x(), low_m.y(), 0}, 1}, depth};
    case 2:
      return {{{high_m.x(), high_m.y(), 0}, 2}, width};
    default:
      return {{{low_m.x(), high_m.y(), 0}, 3}, depth};
  }
}

BuildingSite::BuildingSite(std::uint64_t seed) : seed_(seed) {
  for (const WorldTemplate& entry : office_templates()) define(entry);
}

void BuildingSite::define(const WorldTemplate& entry) {
  world_.templates.push_back(entry);
  bounds_[entry.name] = bounds(entry.features);
}

void BuildingSite::enter(const RectangularRoom& room, const FloorPath& path_m) {
  enter(room.number, {AlignedBox3d(room.low_m, room.high_m)}, {path_m});
}

void BuildingSite::enter(std::uint32_t number,
                         const std::vector<AlignedBox3d>& parts,
                         const std::vector<FloorPath>& paths_m) {
  AlignedBox3d all;
  parts_ = parts;
  for (AlignedBox3d& part : parts_) {
    all.extend(part);
    part.min().array() -= 1e-9;
    part.max().array() += 1e-9;
  }
  room_ = {number, all.min(), all.max()};
  paths_m_ = paths_m;
  occupied_.clear();
}

RandomStream BuildingSite::draws(std::uint32_t item) const {
  return RandomStream(
      {.seed = seed_, .trial = room_.number, .feature = item, .source = building_draws});
}

bool BuildingSite::is_free(const AlignedBox3d& box) const {
  if (std::none_of(parts_.begin(), parts_.end(),
                   [&](const AlignedBox3d& part) { return part.contains(box); })) {
    return false;
  }
  if (box.min().z() < headroom_m &&
      std::any_of(paths_m_.begin(), paths_m_.end(), [&](const FloorPath& path) {
        return distance_to_path(box, path) < route_clearance_m;
      })) {
    return false;
  }
  // Stacked things touch; only neighbours keep a gap.
  const Vector3d gap(site_gap_m, site_gap_m, -1e-6);
  const AlignedBox3d grown(box.min() - gap, box.max() + gap);
  return std::none_of(occupied_.begin(), occupied_.end(),
                      [&](const AlignedBox3d& other) { return grown.intersects(other); });
}

AlignedBox3d BuildingSite::taken(const std::string& name,
                                 const QuarterFrame& frame,
                                 const Vector3d& at_m) const {
  AlignedBox3d box = bounds_.at(name);
  // Nothing is placed between a piece of furniture and its wall.
  if (box.min().y() > 0) box.min().y() = 0;
  return frame * box.translate(at_m);
}

bool BuildingSite::try_place(const std::string& name,
                             const QuarterFrame& frame,
                             const Vector3d& at_m) {
  const AlignedBox3d box = taken(name, frame, at_m);
  if (!is_free(box)) return false;
  occupy(box);
  place(name, frame, at_m);
  return true;
}

void BuildingSite::place(const std::string& name,
                         const QuarterFrame& frame,
                         const Vector3d& at_m,
                         int yaw_deg) {
  const int turned = ((frame.quarters * 90 + yaw_deg) % 360 + 360) % 360;
  world_.instances.push_back({name, to_grid(frame * at_m), turned * (std::numbers::pi / 180)});
}

bool BuildingSite::try_carton(const QuarterFrame& frame, const AlignedBox3d& box) {
  const AlignedBox3d placed = frame * box;
  if (!is_free(placed)) return false;
  occupy(placed);
  loose_.frame = frame;
  const Vector3d &low = box.min(), &high = box.max();
  loose_.box(low, high, standing_faces);
  const double y = (low.y() + high.y()) / 2, flap = 0.2 * (high.z() - low.z());
  loose_.line({low.x(), y, high.z()}, {high.x(), y, high.z()});
  for (const double x : {low.x(), high.x()}) {
    loose_.line({x, y, high.z()}, {x, y, high.z() - flap});
  }
  return true;
}

WorldDescription BuildingSite::finish() {
  std::set<std::string> used;
  for (const auto& instance : world_.instances) used.insert(instance.template_name);
  std::erase_if(world_.templates,
                [&](const WorldTemplate& entry) { return !used.contains(entry.name); });
  world_.loose = loose_.features();
  return std::move(world_);
}

}  // namespace vernier::sim::internal
