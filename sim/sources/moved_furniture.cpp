// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/moved_furniture.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <vector>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace vernier::internal;

namespace {

/// A turn about a place and a step along the floor.
struct Displacement {
  bool moves = false;
  Eigen::Vector2d about_m = Eigen::Vector2d::Zero(), step_m = Eigen::Vector2d::Zero();
  double turn_rad = 0;

  void apply(Eigen::Vector3d& at_m) const {
    const double c = std::cos(turn_rad), s = std::sin(turn_rad);
    const Eigen::Vector2d from = at_m.head<2>() - about_m;
    at_m.head<2>() = about_m + step_m +
                     Eigen::Vector2d(c * from.x() - s * from.y(), s * from.x() + c * from.y());
  }
};

/// Middle of the bounding box of each object on the floor.
std::vector<Eigen::Vector2d> middles(const World& world) {
  const std::size_t count = world.objects.size();
  std::vector<Eigen::Vector2d> low(count, Eigen::Vector2d::Constant(1e9)),
      high(count, Eigen::Vector2d::Constant(-1e9));
  const auto add = [&](std::int32_t object, const Eigen::Vector3d& at_m) {
    const auto i = static_cast<std::size_t>(object);
    low[i] = low[i].cwiseMin(at_m.head<2>());
    high[i] = high[i].cwiseMax(at_m.head<2>());
  };
  for (const WorldSegment& segment : world.segments) {
    add(segment.object, segment.a_m);
    add(segment.object, segment.b_m);
  }
  for (const WorldSurface& surface : world.surfaces) {
    for (const Eigen::Vector3d& corner : surface.polygon_m) add(surface.object, corner);
  }
  for (const WorldCorner& corner : world.corners) add(corner.object, corner.position_m);
  std::vector<Eigen::Vector2d> middle;
  for (std::size_t i = 0; i < count; ++i) middle.push_back(0.5 * (low[i] + high[i]));
  return middle;
}

std::vector<Displacement> displacements(const World& world, double share, std::uint64_t seed) {
  const std::vector<Eigen::Vector2d> middle = middles(world);
  std::vector<Displacement> all(world.objects.size());
  for (std::size_t i = 1; i < all.size(); ++i) {  // object 0: the loose features
    RandomStream draws({.seed = seed,
                        .feature = static_cast<std::uint32_t>(i),
                        .source = static_cast<std::uint32_t>(DrawSource::moved_furniture)});
    Displacement& by = all[i];
    by.moves = draws.uniform() < share && !is_fixture(world.objects[i].template_name);
    const double far_m = draws.uniform(0.3, 1), way = draws.uniform(0, 2 * std::numbers::pi);
    by.step_m = far_m * Eigen::Vector2d(std::cos(way), std::sin(way));
    by.turn_rad = draws.uniform(-0.8, 0.8);
    by.about_m = middle[i];
  }
  return all;
}

}  // namespace

bool is_fixture(std::string_view template_name) {
  constexpr std::string_view fixtures[] = {
      "door_frame", "door_leaf_left", "door_leaf_right", "door_sign", "window", "radiator",
      "ceiling_light", "ceiling_vent", "notice_board", "whiteboard", "socket", "light_switch",
      // homes
      "kitchen_unit", "kitchen_drawers", "kitchen_sink", "kitchen_stove", "wall_cabinet", "bathtub",
      "washbasin", "toilet", "towel_rail", "pendant_lamp",
      // halls and corridors
      "column", "roof_beam", "rack_bay", "gate", "high_window", "electrical_cabinet", "strip_light",
      "closed_door", "double_door", "extinguisher", "handrail", "exit_sign"};
  return std::find(std::begin(fixtures), std::end(fixtures), template_name) != std::end(fixtures);
}

bool has_furniture(const World& world) {
  return std::any_of(world.objects.begin(), world.objects.end(), [](const WorldObject& one) {
    return !one.template_name.empty() && !is_fixture(one.template_name);
  });
}

World with_moved_furniture(const World& world, double share, std::uint64_t seed) {
  World changed = world;
  const std::vector<Displacement> all = displacements(world, share, seed);
  const auto move = [&](std::int32_t object, Eigen::Vector3d& at_m) {
    const Displacement& by = all[static_cast<std::size_t>(object)];
    if (by.moves) by.apply(at_m);
  };
  for (WorldSegment& segment : changed.segments) {
    move(segment.object, segment.a_m);
    move(segment.object, segment.b_m);
  }
  for (WorldCorner& corner : changed.corners) move(corner.object, corner.position_m);
  for (WorldSurface& surface : changed.surfaces) {
    for (Eigen::Vector3d& corner : surface.polygon_m) move(surface.object, corner);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].moves) continue;
    all[i].apply(changed.objects[i].centre_m);
    changed.objects[i].yaw_rad += all[i].turn_rad;
  }
  return changed;
}

}  // namespace vernier::sim
