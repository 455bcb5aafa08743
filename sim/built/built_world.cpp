// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/built/built_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "calib/pose.h"
#include "localise/joined_lines.h"
#include "sim/built/planar_patches.h"
#include "sim/built/upright_line.h"
#include "sim/import/camera_path.h"
#include "sim/world.h"
#include "sim/world/plan_distance.h"

namespace vernier::sim::internal {

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

/// Whether a polygon comes nearer to the way than `radius_m` on the plan.
bool is_near(const std::vector<Vector3d>& polygon_m,
             const std::vector<Vector2d>& way_m,
             double radius_m) {
  return std::any_of(way_m.begin(), way_m.end(), [&](const Vector2d& at) {
    bool inside = true;
    double sign = 0;
    for (std::size_t i = 0, j = polygon_m.size() - 1; i < polygon_m.size(); j = i++) {
      const Vector2d a = polygon_m[j].head<2>(), b = polygon_m[i].head<2>();
      if (plan_distance(at, a, b) < radius_m) return true;
      const double side = (b - a).x() * (at - a).y() - (b - a).y() * (at - a).x();
      inside &= sign * side >= 0;
      if (side != 0) sign = side;
    }
    return inside;
  });
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
  std::vector<Vector2d> way;
  double highest_m = 0;
  for (const Pose& T : T_world_camera) {
    cameras.push_back({"", T.inverse()});
    way.emplace_back(T.t.head<2>());
    highest_m = std::max(highest_m, T.t.z());
  }
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
        is_near(polygon, way, options.walked_m)) {
      ++built.report.on_the_way;
      continue;
    }
    features.surfaces_m.push_back(std::move(polygon));
  }
  built.world.route = route_of(cameras, 1, Vector2d::Zero());
  built.report.lines = features.segments_m.size();
  built.report.surfaces = features.surfaces_m.size();
  built.report.floor_m = floor_height(patches);
  return built;
}

}  // namespace vernier::sim::internal
