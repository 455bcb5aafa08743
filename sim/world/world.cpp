// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/pose.h"
#include "sim/world/world_check.h"

namespace vernier::sim {

using namespace internal;

namespace {

// cos(π/2) is 6e-17 in floating point, which would tilt every wall by rounding: multiples of 90°,
// nearly all rotations in a building, are exact.
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

}  // namespace

namespace {

void check_view_sets(const std::vector<ViewSet>& sets, std::size_t segments) {
  for (std::size_t i = 0; i < sets.size(); ++i) {
    int last = -1;
    for (const int segment : sets[i].segments) {
      if (segment > last && static_cast<std::size_t>(segment) < segments) {
        last = segment;
        continue;
      }
      throw Error("view_dependency " + std::to_string(i),
                  "its segment " + std::to_string(segment) +
                      (segment <= last ? " is not larger than the one before it"
                                       : " is not one of the world's " + std::to_string(segments)),
                  "give ascending indices, from 0");
    }
  }
}

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
    WorldObject& placed = world.objects.emplace_back();
    placed.template_name = instance.template_name;
    placed.yaw_rad = instance.yaw_rad;
    place_features(by_name.at(instance.template_name)->features, pose_of(instance), object, world);
  }
  find_centres(world);
  check_view_sets(description.view_sets, world.segments.size());
  world.view_sets = description.view_sets;
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

}  // namespace vernier::sim
