// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>

#include "calib/error.h"
#include "calib/pose.h"
#include "sim/world_check.h"

namespace vernier {
namespace {

constexpr double kTolerance_m = 1e-3;

// cos(π/2) is 6e-17 in floating point, which would tilt every wall by rounding: quarter turns,
// nearly all of a building, are made exact.
Pose pose_of(const WorldInstance& instance) {
  Pose T_world_template;
  T_world_template.t = instance.at_m;
  const double quarters = instance.yaw_rad / (std::numbers::pi / 2);
  double c = std::cos(instance.yaw_rad), s = std::sin(instance.yaw_rad);
  if (std::abs(quarters - std::round(quarters)) < 1e-12) {
    c = std::round(c);
    s = std::round(s);
  }
  T_world_template.R << c, -s, 0, s, c, 0, 0, 0, 1;
  return T_world_template;
}

void place_features(const FeatureSet& features, const Pose& T, std::int32_t object, World& world) {
  for (const auto& [a, b] : features.segments_m) {
    world.segments.push_back({T * a, T * b, object});
  }
  for (const auto& corner : features.corners_m) world.corners.push_back({T * corner, object});
  for (const auto& polygon : features.surfaces_m) {
    WorldSurface surface{{}, object};
    for (const auto& point : polygon) surface.polygon_m.push_back(T * point);
    world.surfaces.push_back(std::move(surface));
  }
}

void refuse(const std::string& place, const std::optional<WorldFault>& fault) {
  if (fault) throw Error(place, fault->fault, fault->remedy);
}

void check_features(const FeatureSet& features, const std::string& owner) {
  for (std::size_t i = 0; i < features.segments_m.size(); ++i) {
    const auto& [a, b] = features.segments_m[i];
    refuse(owner + " segment " + std::to_string(i), segment_fault(a, b));
  }
  for (std::size_t i = 0; i < features.surfaces_m.size(); ++i) {
    refuse(owner + " surface " + std::to_string(i), surface_fault(features.surfaces_m[i]));
  }
  for (std::size_t i = 0; i < features.corners_m.size(); ++i) {
    if (!features.corners_m[i].allFinite()) {
      throw Error(owner + " corner " + std::to_string(i), "is not finite", "give three numbers");
    }
  }
}

std::map<std::string, const WorldTemplate*> templates_by_name(const WorldDescription& description) {
  std::map<std::string, const WorldTemplate*> by_name;
  for (std::size_t i = 0; i < description.templates.size(); ++i) {
    const WorldTemplate& entry = description.templates[i];
    const std::string place = "template " + std::to_string(i);
    if (entry.name.empty()) throw Error(place, "has no name", "name it");
    if (!by_name.emplace(entry.name, &entry).second) {
      throw Error(place, "the name '" + entry.name + "' is taken", "rename one of the two");
    }
  }
  return by_name;
}

}  // namespace

std::optional<WorldFault> segment_fault(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  if (!a_m.allFinite() || !b_m.allFinite()) {
    return WorldFault{"is not finite", "give six finite numbers"};
  }
  const double length_m = (b_m - a_m).norm();
  if (length_m == 0) return WorldFault{"has no length", "move one end or remove it"};
  // Coordinates have a tenth of a millimetre, so that exactly 1 mm must survive rounding.
  if (length_m < kTolerance_m * (1 - 1e-6)) {
    return WorldFault{"is shorter than 1 mm", "move one end or remove it"};
  }
  return std::nullopt;
}

std::optional<WorldFault> surface_fault(const std::vector<Eigen::Vector3d>& polygon_m) {
  if (polygon_m.size() < 3) {
    return WorldFault{"has fewer than three points", "give three or more"};
  }
  Eigen::Vector3d area = Eigen::Vector3d::Zero(), centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon_m.size(); ++i) {
    if (!polygon_m[i].allFinite()) return WorldFault{"is not finite", "give finite numbers"};
    const Eigen::Vector3d from = polygon_m[i] - polygon_m[0];
    // Newell's normal: the sum over the border holds for polygons that are not convex, too.
    area += 0.5 * from.cross(polygon_m[(i + 1) % polygon_m.size()] - polygon_m[0]);
    centre += polygon_m[i] / static_cast<double>(polygon_m.size());
  }
  if (area.norm() < kTolerance_m * kTolerance_m) {
    return WorldFault{"encloses no area", "check the order of its points or remove it"};
  }
  const Eigen::Vector3d normal = area.normalized();
  for (const auto& point : polygon_m) {
    if (std::abs(normal.dot(point - centre)) > kTolerance_m) {
      return WorldFault{"is not planar to 1 mm", "cut it into triangles"};
    }
  }
  return std::nullopt;
}

std::optional<WorldFault> route_fault(const std::vector<Eigen::Vector2d>& points_m) {
  if (points_m.size() < 2) return WorldFault{"has fewer than two points", "give two or more"};
  for (const auto& point : points_m) {
    if (!point.allFinite()) return WorldFault{"is not finite", "give finite numbers"};
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
      throw Error(place, "there is no template '" + instance.template_name + "'",
                  "define it or name another");
    }
    if (!instance.at_m.allFinite() || !std::isfinite(instance.yaw_rad)) {
      throw Error(place, "its place is not finite", "give finite numbers");
    }
  }
  check_features(description.loose, "loose");
  for (std::size_t i = 0; i < description.route.size(); ++i) {
    refuse("route " + std::to_string(i), route_fault(description.route[i].points_m));
  }
}

namespace {

/// Mean of each object's segment ends.
void find_centres(World& world) {
  std::vector<double> ends(world.objects.size(), 0);
  for (const WorldSegment& segment : world.segments) {
    world.objects[segment.object].centre_m += segment.a_m + segment.b_m;
    ends[segment.object] += 2;
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i] > 0) world.objects[i].centre_m /= ends[i];
  }
}

}  // namespace

World build_world(const WorldDescription& description) {
  check_world(description);
  const auto by_name = templates_by_name(description);
  World world;
  world.name = description.name;
  world.route = description.route;
  world.objects.emplace_back();
  place_features(description.loose, Pose{}, 0, world);
  for (const auto& instance : description.instances) {
    const auto object = static_cast<std::int32_t>(world.objects.size());
    world.objects.emplace_back().template_name = instance.template_name;
    place_features(by_name.at(instance.template_name)->features, pose_of(instance), object, world);
  }
  find_centres(world);
  return world;
}

double repeated_share(const World& world) {
  if (world.segments.empty()) return 0;
  std::map<std::string, int> placed;
  for (const auto& object : world.objects) ++placed[object.template_name];
  std::size_t repeated = 0;
  for (const auto& segment : world.segments) {
    const std::string& name = world.objects[segment.object].template_name;
    if (!name.empty() && placed.at(name) >= 2) ++repeated;
  }
  return static_cast<double>(repeated) / static_cast<double>(world.segments.size());
}

WorldExtent extent(const World& world) {
  if (world.segments.empty()) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  WorldExtent box{world.segments.front().a_m, world.segments.front().a_m};
  for (const auto& segment : world.segments) {
    box.low_m = box.low_m.cwiseMin(segment.a_m).cwiseMin(segment.b_m);
    box.high_m = box.high_m.cwiseMax(segment.a_m).cwiseMax(segment.b_m);
  }
  return box;
}

}  // namespace vernier
