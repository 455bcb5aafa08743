// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/built/built_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "calib/base/plane_vectors.h"
#include "calib/pose.h"
#include "localise/joined_lines.h"
#include "sim/built/planar_patches.h"
#include "sim/built/upright_line.h"
#include "sim/import/camera_path.h"
#include "sim/import/levelled.h"
#include "sim/world.h"
#include "sim/world/plan_distance.h"

namespace vernier::sim::internal {

using vernier::internal::cross;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double level_cosine = 0.97;

std::pair<double, double> heights(const std::vector<Vector3d>& polygon_m) {
  double low = polygon_m[0].z(), high = low;
  for (const Vector3d& p : polygon_m) {
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  }
  return {low, high};
}

double area_of(const std::vector<Vector3d>& polygon_m) {
  Vector3d twice = Vector3d::Zero();
  for (std::size_t i = 2; i < polygon_m.size(); ++i) {
    twice += (polygon_m[i - 1] - polygon_m[0]).cross(polygon_m[i] - polygon_m[0]);
  }
  return 0.5 * twice.norm();
}

/// Level patches that are seen from above, by their height in steps of 5 cm: the lowest of 1 m².
std::optional<double> floor_height(const std::vector<Patch>& patches) {
  constexpr double step_m = 0.05, least_m2 = 1;
  std::map<int, std::pair<double, double>> by_height;  // area, and its moment
  for (const Patch& patch : patches) {
    if (patch.normal.z() < level_cosine) continue;
    const auto [low, high] = heights(patch.polygon_m);
    const double z = 0.5 * (low + high), area = area_of(patch.polygon_m);
    auto& [sum, moment] = by_height[static_cast<int>(std::floor(z / step_m))];
    sum += area;
    moment += area * z;
  }
  for (auto it = by_height.begin(); it != by_height.end(); ++it) {
    // with the step above, since a floor may lie on a border
    auto [sum, moment] = it->second;
    const auto next = by_height.find(it->first + 1);
    if (next != by_height.end()) {
      sum += next->second.first;
      moment += next->second.second;
    }
    if (sum >= least_m2) return moment / sum;
  }
  return {};
}

/// A straight piece of the cameras' way on the floor plan, or one of their places.
struct Step {
  Vector2d from_m, to_m;
};

bool meet(const Step& step, const Vector2d& a, const Vector2d& b) {
  const auto parts = [](const Vector2d& p, const Vector2d& q, const Vector2d& c,
                        const Vector2d& d) {
    return cross(q - p, c - p) * cross(q - p, d - p) < 0;
  };
  return parts(step.from_m, step.to_m, a, b) && parts(a, b, step.from_m, step.to_m);
}

/// Whether a convex polygon comes nearer to a step than `radius_m` on the plan.
bool is_near(const std::vector<Vector3d>& polygon_m, const Step& step, double radius_m) {
  bool inside = true;
  double sign = 0;
  for (std::size_t i = 0, j = polygon_m.size() - 1; i < polygon_m.size(); j = i++) {
    const Vector2d a = polygon_m[j].head<2>(), b = polygon_m[i].head<2>();
    if (meet(step, a, b) || plan_distance(step.from_m, a, b) < radius_m ||
        plan_distance(step.to_m, a, b) < radius_m ||
        plan_distance(a, step.from_m, step.to_m) < radius_m) {
      return true;
    }
    const double side = cross(b - a, step.from_m - a);
    inside &= sign * side >= 0;
    if (side != 0) sign = side;
  }
  return inside;
}

/// Where the cameras were, and their way between, as far as the route has it.
std::vector<Step> steps_of(std::span<const Pose> T_world_camera,
                           const std::vector<RouteLeg>& route) {
  std::vector<Step> steps;
  for (const Pose& T : T_world_camera) steps.push_back({T.t.head<2>(), T.t.head<2>()});
  for (const RouteLeg& leg : route) {
    for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
      steps.push_back({leg.points_m[i - 1], leg.points_m[i]});
    }
  }
  return steps;
}

}  // namespace

BuiltWorld built_world(const localise::JoinedLines& lines,
                       const std::vector<Patch>& patches,
                       std::span<const Pose> T_world_camera,
                       const BuiltWorldOptions& options) {
  BuiltWorld built;
  FeatureSet& features = built.world.loose;
  built.report.joined = lines.lines.size();
  for (std::size_t i = 0; i < lines.lines.size(); ++i) {
    const localise::JoinedLine& line = lines.lines[i];
    if (line.views < options.min_sightings) continue;
    if ((line.b_m - line.a_m).norm() < options.shortest_m) continue;
    auto& [a_m, b_m] = features.segments_m.emplace_back(line.a_m, line.b_m);
    if (options.upright_rad > 0 && may_be_upright(line, options.upright_rad)) {
      make_upright(a_m, b_m);
      ++built.report.upright;
    }
    built.of_lines.push_back(static_cast<int>(i));
  }
  std::vector<PathCamera> cameras;
  double highest_m = 0;
  for (const Pose& T : T_world_camera) {
    cameras.push_back({"", T.inverse()});
    highest_m = std::max(highest_m, T.t.z());
  }
  built.world.route = route_of(cameras, 1, Vector2d::Zero());
  const std::vector<Step> way = steps_of(T_world_camera, built.world.route);
  constexpr double above_camera_m = 0.2;
  for (const Patch& patch : patches) {
    std::vector<Vector3d> polygon = patch.polygon_m;
    const auto [low, high] = heights(polygon);
    const bool is_floor =
        patch.normal.z() > level_cosine && high < options.floor_m && low > -options.floor_m;
    for (Vector3d& p : polygon) {
      if (is_floor) p.z() = -options.recede_m;
      if (!is_floor) p -= options.recede_m * patch.normal;
    }
    if (!is_floor && low < highest_m + above_camera_m && high > 0 &&
        std::any_of(way.begin(), way.end(),
                    [&](const Step& step) { return is_near(polygon, step, options.walked_m); })) {
      ++built.report.on_the_way;
      continue;
    }
    features.surfaces_m.push_back(std::move(polygon));
  }
  built.report.lines = features.segments_m.size();
  built.report.surfaces = features.surfaces_m.size();
  built.report.floor_m = floor_height(patches);
  return built;
}

}  // namespace vernier::sim::internal
