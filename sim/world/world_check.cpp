// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world_check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "sim/world.h"
#include "sim/world/world_limits.h"

namespace vernier::sim::internal {
namespace {

constexpr double kTolerance_m = 1e-3;

void refuse(const std::string& place, const std::optional<WorldError>& fault) {
  if (fault) throw Error(place, fault->fault, fault->remedy);
}

void check_features(const FeatureSet& features, const std::string& owner) {
  for (std::size_t i = 0; i < features.segments_m.size(); ++i) {
    const auto& [a, b] = features.segments_m[i];
    refuse(owner + " segment " + std::to_string(i), segment_error(a, b));
  }
  for (std::size_t i = 0; i < features.surfaces_m.size(); ++i) {
    refuse(owner + " surface " + std::to_string(i), surface_error(features.surfaces_m[i]));
  }
  for (std::size_t i = 0; i < features.corners_m.size(); ++i) {
    refuse(owner + " corner " + std::to_string(i), point_error(features.corners_m[i]));
  }
}

bool is_far(double coordinate_m) { return std::abs(coordinate_m) > largest_coordinate_m; }

WorldError too_far() {
  return {fmt::format("is farther than {:g} m from the origin along an axis", largest_coordinate_m),
          "give metres, from an origin near the world"};
}

struct FeatureCount {
  std::uint64_t segments = 0, corners = 0, surfaces = 0;

  void add(const FeatureSet& features) {
    segments += features.segments_m.size();
    corners += features.corners_m.size();
    surfaces += features.surfaces_m.size();
  }
};

std::optional<WorldError> route_size_error(const std::vector<RouteLeg>& route) {
  std::size_t points = 0;
  for (const RouteLeg& leg : route) points += leg.points_m.size();
  if (points > most_route_points) {
    return WorldError{
        fmt::format("has a route of {} points, more than {}", points, most_route_points),
        "give fewer points"};
  }
  if (const double length_m = route_length_m(route); !(length_m <= longest_route_m)) {
    return WorldError{
        fmt::format("has a route of {:g} m, longer than {:g} m", length_m, longest_route_m),
        "give a shorter route, in metres"};
  }
  return std::nullopt;
}

}  // namespace

std::map<std::string, const WorldTemplate*> templates_by_name(const WorldDescription& description) {
  std::map<std::string, const WorldTemplate*> by_name;
  for (std::size_t i = 0; i < description.templates.size(); ++i) {
    const WorldTemplate& entry = description.templates[i];
    const std::string place = "template " + std::to_string(i);
    if (entry.name.empty()) throw Error(place, "has no name", "add a name");
    if (!by_name.emplace(entry.name, &entry).second) {
      throw Error(place, "duplicate name '" + vernier::internal::shortened(entry.name) + "'",
                  "rename one of the two");
    }
  }
  return by_name;
}

std::optional<WorldError> point_error(const Eigen::Vector3d& point_m) {
  if (!point_m.allFinite()) return WorldError{"is not finite", "use finite numbers"};
  if (is_far(point_m.cwiseAbs().maxCoeff())) return too_far();
  return std::nullopt;
}

std::optional<WorldError> segment_error(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  if (!a_m.allFinite() || !b_m.allFinite()) {
    return WorldError{"is not finite", "use six finite numbers"};
  }
  for (const Eigen::Vector3d* end : {&a_m, &b_m}) {
    if (const auto fault = point_error(*end)) return fault;
  }
  const double length_m = (b_m - a_m).norm();
  if (length_m == 0) return WorldError{"has zero length", "move one end or remove it"};
  // Coordinates are rounded to a tenth of a millimetre, so that exactly 1 mm must be accepted
  // despite rounding.
  if (length_m < kTolerance_m * (1 - 1e-6)) {
    return WorldError{"is shorter than 1 mm", "move one end or remove it"};
  }
  return std::nullopt;
}

std::optional<WorldError> surface_error(const std::vector<Eigen::Vector3d>& polygon_m) {
  if (polygon_m.size() < 3) {
    return WorldError{"has fewer than three points", "use at least three"};
  }
  if (polygon_m.size() > most_polygon_points) {
    return WorldError{
        fmt::format("has {} points, more than {}", polygon_m.size(), most_polygon_points),
        "split it into smaller ones"};
  }
  Eigen::Vector3d area = Eigen::Vector3d::Zero(), centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon_m.size(); ++i) {
    if (const auto fault = point_error(polygon_m[i])) return fault;
    const Eigen::Vector3d from = polygon_m[i] - polygon_m[0];
    // Newell's normal, valid for non-convex polygons too.
    area += 0.5 * from.cross(polygon_m[(i + 1) % polygon_m.size()] - polygon_m[0]);
    centre += polygon_m[i] / static_cast<double>(polygon_m.size());
  }
  if (area.norm() < kTolerance_m * kTolerance_m) {
    return WorldError{"has no area", "check the order of its points or remove it"};
  }
  const Eigen::Vector3d normal = area.normalized();
  for (const auto& point : polygon_m) {
    if (std::abs(normal.dot(point - centre)) > kTolerance_m) {
      return WorldError{"is not planar to 1 mm", "split it into triangles"};
    }
  }
  return std::nullopt;
}

std::optional<WorldError> route_error(const std::vector<Eigen::Vector2d>& points_m) {
  if (points_m.size() < 2) return WorldError{"has fewer than two points", "use at least two"};
  for (const auto& point : points_m) {
    if (const auto fault = point_error({point.x(), point.y(), 0})) return fault;
  }
  return std::nullopt;
}

double reach_m(const FeatureSet& features) {
  double reach = 0;
  const auto take_in = [&](const Eigen::Vector3d& p) {
    reach = std::max({reach, p.head<2>().norm(), std::abs(p.z())});
  };
  for (const auto& [a, b] : features.segments_m) {
    take_in(a);
    take_in(b);
  }
  for (const auto& corner : features.corners_m) take_in(corner);
  for (const auto& polygon : features.surfaces_m) {
    for (const auto& point : polygon) take_in(point);
  }
  return reach;
}

std::optional<WorldError> instance_error(const WorldInstance& instance, double template_reach_m) {
  if (!instance.at_m.allFinite() || !std::isfinite(instance.yaw_rad)) {
    return WorldError{"has a position that is not finite", "use finite numbers"};
  }
  if (is_far(instance.at_m.cwiseAbs().maxCoeff() + template_reach_m)) return too_far();
  return std::nullopt;
}

std::optional<WorldError> size_error(const WorldDescription& description) {
  std::map<std::string_view, const FeatureSet*> by_name;
  for (const WorldTemplate& entry : description.templates) {
    by_name.emplace(entry.name, &entry.features);
  }
  FeatureCount count;
  count.add(description.loose);
  for (const WorldInstance& instance : description.instances) {
    const auto found = by_name.find(instance.template_name);
    if (found != by_name.end()) count.add(*found->second);
  }
  for (const auto& [what, number] :
       {std::pair<const char*, std::uint64_t>{"segments", count.segments},
        {"corners", count.corners},
        {"surfaces", count.surfaces},
        {"objects", description.instances.size()}}) {
    if (number <= most_features) continue;
    return WorldError{fmt::format("has {} {}, more than {}", number, what, most_features),
                      "split the world, or leave out details"};
  }
  return route_size_error(description.route);
}

std::optional<WorldError> floor_error(const WorldDescription& description) {
  constexpr double lowest_m = 0, highest_m = 4;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take_in = [&](const FeatureSet& features, double z) {
    const auto add = [&](const Eigen::Vector3d& point) {
      low = std::min(low, z + point.z());
      high = std::max(high, z + point.z());
    };
    for (const auto& [a, b] : features.segments_m) {
      add(a);
      add(b);
    }
    for (const auto& polygon : features.surfaces_m) {
      for (const Eigen::Vector3d& point : polygon) add(point);
    }
    for (const Eigen::Vector3d& corner : features.corners_m) add(corner);
  };
  take_in(description.loose, 0);
  const auto by_name = templates_by_name(description);
  for (const WorldInstance& instance : description.instances) {
    const auto found = by_name.find(instance.template_name);
    if (found != by_name.end()) take_in(found->second->features, instance.at_m.z());
  }
  if (low > high || (low <= highest_m && high >= lowest_m)) return std::nullopt;
  return WorldError{fmt::format("lies from {:g} to {:g} m, and the floor is at z = 0", low, high),
                    "shift it, so that robots stand on its floor"};
}

void check_world(const WorldDescription& description) {
  const auto by_name = templates_by_name(description);
  for (std::size_t i = 0; i < description.route.size(); ++i) {
    refuse("route " + std::to_string(i), route_error(description.route[i].points_m));
  }
  refuse("world", size_error(description));
  std::map<std::string, double> reaches_m;
  for (const auto& entry : description.templates) {
    check_features(entry.features, "template '" + entry.name + "'");
    reaches_m[entry.name] = reach_m(entry.features);
  }
  for (std::size_t i = 0; i < description.instances.size(); ++i) {
    const WorldInstance& instance = description.instances[i];
    const std::string place = "instance " + std::to_string(i);
    if (!by_name.contains(instance.template_name)) {
      throw Error(place,
                  "unknown template '" + vernier::internal::shortened(instance.template_name) + "'",
                  "define it or use another");
    }
    refuse(place, instance_error(instance, reaches_m.at(instance.template_name)));
  }
  check_features(description.loose, "loose");
}

}  // namespace vernier::sim::internal
