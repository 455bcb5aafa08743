// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/corridors.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/corridor_fittings.h"
#include "sim/buildings/office_clutter.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/space.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::AlignedBox2d;
using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double along_pitch_m = 10, across_pitch_m = 12;  ///< between corridors, about
constexpr double corridor_end_m = 0.6;                     ///< of the route, from a dead end

enum CorridorItem : std::uint32_t {
  corridor_layout_item = 0,
  corridor_light_item = 20,
  corridor_wall_item = 100,
};

/// A corridor along x (axis 0) or y, `from` to `to` along that axis.
struct Corridor {
  int axis = 0;
  double middle_m = 0, width_m = 2, from_m = 0, to_m = 0;

  AlignedBox2d floor() const {
    Vector2d low, high;
    low[axis] = to_grid(from_m);
    high[axis] = to_grid(to_m);
    low[1 - axis] = to_grid(middle_m - width_m / 2);
    high[1 - axis] = to_grid(middle_m + width_m / 2);
    return {low, high};
  }
};

void check_corridors(const Vector3d& size) {
  const auto refuse = [](const std::string& fault, const std::string& remedy) {
    throw Error("corridors", fault, remedy);
  };
  if (!size.allFinite()) refuse("a size is not finite", "use finite lengths in metres");
  if (size.maxCoeff() > 500) refuse("a length is above 500 m", "use at most 500 m");
  if (size.z() < 2.3) refuse("the height is below 2.3 m", "use at least 2.3 m, for the doors");
  if (size.head<2>().minCoeff() < 4) refuse("no corridor fits", "use at least 4 m each way");
}

// Middles of corridors, at about even distances.
std::vector<double> places(double length, double pitch, double jitter, RandomStream& draws) {
  const int count = static_cast<int>(std::round(length / pitch));
  jitter = std::min(jitter, 0.15 * length / std::max(count, 1));
  std::vector<double> middles;
  for (int i = 0; i < count; ++i) {
    middles.push_back(length * (i + 0.5) / count + draws.uniform(-jitter, jitter));
  }
  return middles;
}

std::vector<Corridor> lay_corridors(const Vector3d& size, RandomStream& draws) {
  const double length = size.x(), width = size.y(), middle = to_grid(width / 2);
  std::vector<double> along = places(width, along_pitch_m, 1.2, draws);
  std::vector<double> across = places(length, across_pitch_m, 2.5, draws);
  // The one nearest to the middle lies there and goes from end to end.
  if (along.empty()) along.push_back(middle);
  *std::min_element(along.begin(), along.end(), [&](double a, double b) {
    return std::abs(a - middle) < std::abs(b - middle);
  }) = middle;
  std::vector<Corridor> corridors;
  for (const double y : along) {
    const double wide = to_grid(draws.uniform(1.8, 2.4));
    const bool to_low = draws.uniform() < 0.4, to_high = draws.uniform() < 0.4;
    if (y == middle) {
      corridors.insert(corridors.begin(), {0, y, wide, 0, length});
    } else if (!across.empty()) {
      corridors.push_back(
          {0, y, wide, to_low ? 0 : across.front(), to_high ? length : across.back()});
    }
  }
  for (const double x : across) {
    const double wide = to_grid(draws.uniform(1.8, 2.4));
    const bool to_low = along.size() == 1 || draws.uniform() < 0.5;
    const bool to_high = along.size() == 1 || draws.uniform() < 0.5;
    corridors.push_back({1, x, wide, to_low ? 0 : along.front(), to_high ? width : along.back()});
  }
  // Corridors that end at another reach its far wall.
  for (Corridor& corridor : corridors) {
    for (const Corridor& other : corridors) {
      if (other.axis == corridor.axis) continue;
      if (corridor.from_m == other.middle_m) corridor.from_m -= other.width_m / 2;
      if (corridor.to_m == other.middle_m) corridor.to_m += other.width_m / 2;
    }
  }
  return corridors;
}

// Along the middle of a corridor, up to the doorways of the ends that it leads to.
RouteLeg leg_of(const Corridor& corridor, const OpenEnds& leads_to) {
  Vector2d from, to;
  from[corridor.axis] = corridor.from_m + (leads_to.low_x ? 0 : corridor_end_m);
  to[corridor.axis] = corridor.to_m - (leads_to.high_x ? 0 : corridor_end_m);
  from[1 - corridor.axis] = to[1 - corridor.axis] = corridor.middle_m;
  RouteLeg leg;
  for (const Vector2d& point : {from, to}) {
    leg.points_m.emplace_back(to_grid(point.x()), to_grid(point.y()));
  }
  return leg;
}

// Doors at even distances, as many as fit, and their signs.
void hang_closed_doors(BuildingSite& site,
                       const RoomWall& wall,
                       double pitch,
                       RandomStream& draws) {
  const double start = draws.uniform(0.7, std::max(0.8, 0.5 * pitch));
  for (double x = start; x + 0.7 < wall.length_m; x += pitch) {
    const bool is_there = draws.uniform() < 0.9, is_double = draws.uniform() < 0.08;
    const char* name = is_double ? "double_door" : "closed_door";
    if (!is_there || !site.try_place(name, wall.frame, {x, 0, 0})) continue;
    site.try_place("door_sign", wall.frame, {x + (is_double ? 1.06 : 0.62), 0, 0});
  }
}

void furnish_corridor_side(BuildingSite& site,
                           const RoomWall& wall,
                           const Vector3d& size,
                           double pitch,
                           std::uint32_t number) {
  RandomStream draws = site.draws(corridor_wall_item + number);
  const double length = wall.length_m;
  const auto anywhere = [&](double width) {
    return draws.uniform(0.05, std::max(0.06, length - width - 0.05));
  };
  const Vector3d& origin = wall.frame.origin_m;
  const Vector3d end = wall.frame * Vector3d(length, 0, 0);
  const auto on_outline = [&](int axis) {
    return origin[axis] == end[axis] && (origin[axis] == 0 || origin[axis] == size[axis]);
  };
  if ((on_outline(0) || on_outline(1)) && length > 1.8) {
    // Dead ends and outer walls have windows, in place of doors.
    for (double x = 0.15; x + 1.6 < length; x += 3) {
      site.try_place("window", wall.frame, {x + 0.05, 0, 0});
    }
  } else {
    hang_closed_doors(site, wall, pitch, draws);
  }
  for (int i = 0; i < static_cast<int>(length / 3); ++i) {
    const double kind = draws.uniform();
    if (kind < 0.15) {
      site.try_place("bench", wall.frame, {anywhere(1.5), 0, 0});
    } else if (kind < 0.3) {
      site.try_place("extinguisher", wall.frame, {anywhere(0.3) + 0.05, 0, 0});
    } else if (kind < 0.55) {
      site.try_place("handrail", wall.frame, {anywhere(1.8), 0, 0});
    } else if (kind < 0.65) {
      site.try_place("radiator", wall.frame, {anywhere(1.3), 0, 0});
    } else if (kind < 0.75) {
      site.try_place("tea_trolley", wall.frame, {anywhere(0.9), 0, 0});
    } else if (kind < 0.85) {
      const double x = anywhere(1.3);
      if (site.try_place("notice_board", wall.frame, {x, 0, 0})) {
        pin_papers(site, wall.frame, {x + 0.03, 1.18}, {x + 1.17, 1.97}, draws);
      }
    } else {
      site.try_place("socket", wall.frame, {anywhere(0.3), 0, 0});
    }
  }
  hang_pictures(site, wall, static_cast<int>(length / 4), draws);
  if (draws.uniform() < 0.15) drop_cartons(site, wall, 1, draws);
}

void light_corridor(BuildingSite& site, const Corridor& corridor, double height) {
  const double length = corridor.to_m - corridor.from_m;
  const int lights = std::max(1, static_cast<int>(std::round(length / 2.4)));
  for (int i = 0; i < lights; ++i) {
    Vector3d at(corridor.middle_m, corridor.middle_m, height);
    at[corridor.axis] = corridor.from_m + length * (i + 0.5) / lights;
    site.place("ceiling_light", {at, corridor.axis}, Vector3d::Zero());
  }
  for (const bool high : {false, true}) {
    Vector3d at(corridor.middle_m, corridor.middle_m, height);
    at[corridor.axis] = high ? corridor.to_m - 2.6 : corridor.from_m + 2.6;
    if (length > 8) site.place("exit_sign", {at, 1 - corridor.axis}, Vector3d::Zero());
  }
}

}  // namespace

WorldDescription make_corridors(std::uint64_t seed, const CorridorOptions& options) {
  check_corridors(options.size_m);
  const Vector3d size = to_grid(options.size_m);
  RandomStream draws(
      {.seed = seed, .trial = 0, .feature = corridor_layout_item, .source = building_draws});
  const std::vector<Corridor> corridors = lay_corridors(size, draws);
  const double pitch = draws.uniform(2.8, 4.2);

  std::vector<AlignedBox2d> floor;
  std::vector<AlignedBox3d> parts;
  std::vector<FloorPath> paths;
  std::vector<RouteLeg> route;
  for (const Corridor& corridor : corridors) {
    floor.push_back(corridor.floor());
    parts.emplace_back(Vector3d(floor.back().min().x(), floor.back().min().y(), 0),
                       Vector3d(floor.back().max().x(), floor.back().max().y(), size.z()));
    // The first corridor is the one that goes from end to end.
    route.push_back(leg_of(corridor, route.empty() ? options.open : OpenEnds{}));
    paths.push_back(route.back().points_m);
  }
  const std::vector<RoomWall> walls = walls_around(floor);
  const std::vector<Opening> openings = end_openings(walls, size, options.open);

  BuildingSite site(seed);
  for (const WorldTemplate& entry : corridor_templates()) site.define(entry);
  raise_room(site.loose(), floor, walls, size.z(), openings);
  site.enter(1, parts, paths);
  fit_end_doorways(site, walls, openings, casing_m + 0.02, 0.8);
  for (const Corridor& corridor : corridors) light_corridor(site, corridor, size.z());
  for (std::uint32_t i = 0; i < walls.size(); ++i) {
    furnish_corridor_side(site, walls[i], size, pitch, i);
  }
  WorldDescription world = site.finish();
  world.name = "corridors-" + std::to_string(seed);
  world.route = std::move(route);
  return world;
}

}  // namespace vernier::sim::internal
