// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world_check.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "calib/error.h"
#include "sim/world.h"

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
    if (!features.corners_m[i].allFinite()) {
      throw Error(owner + " corner " + std::to_string(i), "is not finite",
                  "use three finite numbers");
    }
  }
}

}  // namespace

std::map<std::string, const WorldTemplate*> templates_by_name(const WorldDescription& description) {
  std::map<std::string, const WorldTemplate*> by_name;
  for (std::size_t i = 0; i < description.templates.size(); ++i) {
    const WorldTemplate& entry = description.templates[i];
    const std::string place = "template " + std::to_string(i);
    if (entry.name.empty()) throw Error(place, "has no name", "add a name");
    if (!by_name.emplace(entry.name, &entry).second) {
      throw Error(place, "duplicate name '" + entry.name + "'", "rename one of the two");
    }
  }
  return by_name;
}

std::optional<WorldError> segment_error(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  if (!a_m.allFinite() || !b_m.allFinite()) {
    return WorldError{"is not finite", "use six finite numbers"};
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
  Eigen::Vector3d area = Eigen::Vector3d::Zero(), centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon_m.size(); ++i) {
    if (!polygon_m[i].allFinite()) return WorldError{"is not finite", "use finite numbers"};
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
    if (!point.allFinite()) return WorldError{"is not finite", "use finite numbers"};
  }
  return std::nullopt;
}

void check_world(const WorldDescription& description) {
  const auto by_name = templates_by_name(description);
  for (const auto& entry : description.templates) {
    check_features(entry.features, "template '" + entry.name + "'");
  }
  for (std::size_t i = 0; i < description.instances.size(); ++i) {
    const WorldInstance& instance = description.instances[i];
    const std::string place = "instance " + std::to_string(i);
    if (!by_name.contains(instance.template_name)) {
      throw Error(place, "unknown template '" + instance.template_name + "'",
                  "define it or use another");
    }
    if (!instance.at_m.allFinite() || !std::isfinite(instance.yaw_rad)) {
      throw Error(place, "its position is not finite", "use finite numbers");
    }
  }
  check_features(description.loose, "loose");
  for (std::size_t i = 0; i < description.route.size(); ++i) {
    refuse("route " + std::to_string(i), route_error(description.route[i].points_m));
  }
}

}  // namespace vernier::sim::internal
