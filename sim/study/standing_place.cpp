// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/standing_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/study/floor_grid.h"
#include "sim/visibility.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"
#include "sim/world/plan_distance.h"

namespace vernier::sim::internal {

using namespace localise;

namespace {

constexpr double floor_m = 0.02;  ///< what lies lower is the floor itself

/// Height of the highest level surface over a point, such as a ceiling; infinite if there is none.
double ceiling_height_m(const World& world, const Eigen::Vector2d& at_m) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const WorldSurface& surface : world.surfaces) {
    double low = surface.polygon_m[0].z(), high = low;
    for (const auto& point : surface.polygon_m) {
      low = std::min(low, point.z());
      high = std::max(high, point.z());
    }
    if (high < floor_m || high - low >= 1e-6 || !inside_plan(at_m, surface.polygon_m)) continue;
    highest = std::max(highest, high);
  }
  return std::isinf(highest) ? -highest : highest;
}

/// Whether a path of short straight steps, free of surfaces at eye height, connects a point to the
/// route: first a direct line of sight to the route, then a search over a grid through the point.
class WayToRoute {
 public:
  WayToRoute(const Visibility& visibility, double height_m)
      : visibility_(visibility), box_(standing_box(visibility.world())), height_m_(height_m) {
    double passed = 0, next = 0;  // along the route
    for (const RouteLeg& leg : visibility.world().route) {
      for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
        const Eigen::Vector2d &a = leg.points_m[i - 1], &b = leg.points_m[i];
        const double length = (b - a).norm();
        for (; next < passed + length; next += step_m) {
          add_route_point(a + (next - passed) / length * (b - a));
        }
        passed += length;
      }
    }
  }

  bool leads_from(const Eigen::Vector2d& start_m) const {
    const auto meets = [&](const Eigen::Vector2d& q) { return sees(q, start_m); };
    if (on_route_.empty() || std::any_of(on_route_.begin(), on_route_.end(), meets)) return true;
    std::set<std::pair<int, int>> reached{{0, 0}};
    std::vector<std::pair<int, int>> open{{0, 0}};
    const auto at = [&](const std::pair<int, int>& cell) {
      return Eigen::Vector2d(start_m.x() + step_m * cell.first, start_m.y() + step_m * cell.second);
    };
    while (!open.empty()) {
      const std::pair<int, int> cell = open.back();
      open.pop_back();
      const Eigen::Vector2d here = at(cell);
      if (meets_route(here) || reached.size() > most_cells) return true;
      for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        const std::pair<int, int> next{cell.first + dx, cell.second + dy};
        if (!in_box(at(next)) || reached.count(next) > 0 || !steps(here, at(next))) continue;
        reached.insert(next);
        open.push_back(next);
      }
    }
    return false;
  }

 private:
  static constexpr double step_m = 0.25;
  /// Of 15,000 m²: a larger space is not the inside of anything.
  static constexpr std::size_t most_cells = 240'000;

  bool in_box(const Eigen::Vector2d& p) const {
    return (p.array() >= box_.low_m.head<2>().array()).all() &&
           (p.array() <= box_.high_m.head<2>().array()).all();
  }
  bool sees(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
    return visibility_.sees({from.x(), from.y(), height_m_}, {to.x(), to.y(), height_m_});
  }
  /// Extends the line of sight a little, because a point on a surface is visible from both sides.
  bool steps(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
    constexpr double beyond = 0.04;
    return sees(from, to + beyond * (to - from));
  }
  bool meets_route(const Eigen::Vector2d& p) const {
    constexpr double within_m = 1.5 * step_m;
    return route_grid_.any_near(p, within_m, [&](int i) {
      return (on_route_[i] - p).norm() <= within_m && sees(on_route_[i], p);
    });
  }
  void add_route_point(const Eigen::Vector2d& at_m) {
    route_grid_.add(at_m, static_cast<int>(on_route_.size()));
    on_route_.push_back(at_m);
  }

  const Visibility& visibility_;
  WorldExtent box_;
  double height_m_;
  std::vector<Eigen::Vector2d> on_route_;
  FloorGrid route_grid_{2 * step_m};
};

}  // namespace

bool inside_plan(const Eigen::Vector2d& at_m, const std::vector<Eigen::Vector3d>& polygon_m) {
  return inside_outline({at_m.x(), at_m.y(), 0}, polygon_m, 2);
}

ProtocolSpan span(QueryProtocol protocol) {
  constexpr double degree = std::numbers::pi / 180;
  switch (protocol) {
    case QueryProtocol::near_path:
      return {0.1, 5 * degree};
    case QueryProtocol::path:
      return {0.3, 15 * degree};
    case QueryProtocol::anywhere:
    case QueryProtocol::free:  // has no span: farther is free too
      break;
  }
  return {0.6, 180 * degree};
}

WorldExtent standing_box(const World& world) {
  WorldExtent box{Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
                  Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity())};
  const auto take_in = [&](const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m) {
    box.low_m = box.low_m.cwiseMin(low_m);
    box.high_m = box.high_m.cwiseMax(high_m);
  };
  for (const WorldSegment& segment : world.segments) {
    take_in(segment.a_m, segment.a_m);
    take_in(segment.b_m, segment.b_m);
  }
  for (const WorldSurface& surface : world.surfaces) {
    for (const Eigen::Vector3d& point : surface.polygon_m) take_in(point, point);
  }
  const double across_m = span(QueryProtocol::anywhere).across_m;
  const Eigen::Vector3d about(across_m, across_m, 0);
  for (const RouteLeg& leg : world.route) {
    for (const Eigen::Vector2d& p : leg.points_m) {
      const Eigen::Vector3d at(p.x(), p.y(), 0);
      take_in(at - about, at + about);
    }
  }
  if (box.low_m.x() > box.high_m.x()) return extent(world);  // an empty world
  box.low_m.z() = std::min(0.0, box.low_m.z());
  return box;
}

bool blocks(const WorldSurface& surface,
            const Eigen::Vector2d& at_m,
            double radius_m,
            double height_m) {
  const auto& polygon = surface.polygon_m;
  double low = polygon[0].z(), high = low;
  for (const auto& point : polygon) {
    low = std::min(low, point.z());
    high = std::max(high, point.z());
  }
  if (low > height_m || high < floor_m) return false;
  if (high - low < 1e-6 && inside_plan(at_m, polygon)) return true;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    if (plan_distance(at_m, polygon[i].head<2>(), polygon[j].head<2>()) < radius_m) return true;
  }
  return false;
}

bool is_free(const World& world, const Eigen::Vector2d& at_m, double radius_m, double height_m) {
  return std::none_of(world.surfaces.begin(), world.surfaces.end(), [&](const auto& surface) {
    return blocks(surface, at_m, radius_m, height_m);
  });
}

std::string standing_fault(const Visibility& visibility, const Pose2D& pose, double eye_height_m) {
  const World& world = visibility.world();
  const WorldExtent box = standing_box(world);
  if (!(pose.x_m >= box.low_m.x() && pose.x_m <= box.high_m.x() && pose.y_m >= box.low_m.y() &&
        pose.y_m <= box.high_m.y())) {
    const WorldExtent own = world.segments.empty() ? box : extent(world);
    return fmt::format("is outside the world, which extends from ({:g}, {:g}) to ({:g}, {:g}) m",
                       own.low_m.x(), own.low_m.y(), own.high_m.x(), own.high_m.y());
  }
  const Eigen::Vector2d at(pose.x_m, pose.y_m);
  if (!(eye_height_m >= box.low_m.z())) {
    return fmt::format("is at a height of {:g} m, below the floor at {:g} m", eye_height_m,
                       box.low_m.z());
  }
  if (const double ceiling_m = ceiling_height_m(world, at); !(eye_height_m <= ceiling_m)) {
    return fmt::format("is at a height of {:g} m, above the ceiling at {:g} m", eye_height_m,
                       ceiling_m);
  }
  if (!is_free(world, at, robot_radius_m, eye_height_m + robot_top_m)) {
    return fmt::format("has a surface nearer than {:g} m, or less than {:g} m above the camera",
                       robot_radius_m, robot_top_m);
  }
  if (!WayToRoute(visibility, eye_height_m).leads_from(at)) {
    return "is not reachable from the route, as inside a wall or a cupboard";
  }
  return "";
}

}  // namespace vernier::sim::internal
