// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/office.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/office_clutter.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/office_room.h"
#include "sim/buildings/space.h"
#include "sim/buildings/wire_shapes.h"
#include "sim/world.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double route_end_m = 0.6;  ///< distance from the end walls of the corridor
constexpr double window_room_m =
    1.2;  ///< distance between the end of a room's leg and its outer wall
constexpr std::uint32_t corridor_number = 0;  ///< rooms count from 1
constexpr std::uint32_t door_place_item = 100;

struct Room {
  RectangularRoom floor;
  int window_side = 0;  ///< 0 south of the corridor, 2 north of it
  double door_x_m = 0;  ///< middle of the opening, world
  RouteLeg leg;
};

/// Everything determined by the options before any draw, and the rooms' doors.
struct Plan {
  Vector3d size_m;
  double south_m = 0, north_m = 0;  ///< the corridor's faces
  std::vector<Room> rooms;          ///< south side first, by x
  OpenEnds open;
};

void check_options(const OfficeOptions& options) {
  const Vector3d& size = options.size_m;
  const auto refuse = [](const std::string& fault, const std::string& remedy) {
    throw Error("office", fault, remedy);
  };
  if (!size.allFinite() || !std::isfinite(options.corridor_width_m) ||
      !std::isfinite(options.room_width_m)) {
    refuse("a size is not finite", "use finite lengths in metres");
  }
  if (size.maxCoeff() > 200) refuse("a length is above 200 m", "use at most 200 m");
  if (size.z() < 2.3)
    refuse("the height is below 2.3 m", "use at least 2.3 m, for the door frames");
  if (options.corridor_width_m < 1.2)
    refuse("the corridor is narrower than 1.2 m", "use at least 1.2 m");
  if (options.room_width_m < 2.8) refuse("the rooms are narrower than 2.8 m", "use at least 2.8 m");
  if (size.x() < 2.8) refuse("no room fits in the length", "use at least 2.8 m");
  if ((size.y() - options.corridor_width_m) / 2 - wall_thickness_m < 2.8) {
    refuse("no room fits beside the corridor", "increase the width; rooms must be 2.8 m deep");
  }
}

RouteLeg room_leg(const Room& room, double corridor_m) {
  const Vector3d low = room.floor.low_m, high = room.floor.high_m;
  const bool south = room.window_side == 0;
  const double door_y = south ? high.y() : low.y(), into = south ? -1 : 1;
  const double depth = high.y() - low.y(), middle_x = (low.x() + high.x()) / 2;
  RouteLeg leg;
  leg.points_m = {{room.door_x_m, corridor_m},
                  {room.door_x_m, door_y + 0.5 * into},
                  {middle_x, door_y + 0.5 * depth * into}};
  if (depth / 2 > window_room_m + 0.1) {
    leg.points_m.push_back({middle_x, door_y + (depth - window_room_m) * into});
  }
  for (auto& point : leg.points_m) point = {to_grid(point.x()), to_grid(point.y())};
  return leg;
}

Plan make_plan(std::uint64_t seed, const OfficeOptions& options) {
  Plan plan;
  plan.open = options.open;
  plan.size_m = to_grid(options.size_m);
  plan.south_m = to_grid((plan.size_m.y() - options.corridor_width_m) / 2);
  plan.north_m = plan.size_m.y() - plan.south_m;
  const double length = plan.size_m.x(), half = wall_thickness_m / 2;
  const int along = std::max(1, static_cast<int>(std::floor(length / options.room_width_m + 0.5)));
  const int fitting = std::clamp(along, 1, static_cast<int>(length / 2.8));
  for (int side = 0; side < 2; ++side) {
    for (int k = 0; k < fitting; ++k) {
      Room room;
      room.floor.number = static_cast<std::uint32_t>(1 + side * fitting + k);
      room.window_side = side == 0 ? 0 : 2;
      const double x0 = k == 0 ? 0 : k * length / fitting + half;
      const double x1 = k + 1 == fitting ? length : (k + 1) * length / fitting - half;
      room.floor.low_m = {x0, side == 0 ? 0 : plan.north_m + wall_thickness_m, 0};
      room.floor.high_m = {x1, side == 0 ? plan.south_m - wall_thickness_m : plan.size_m.y(),
                           plan.size_m.z()};
      RandomStream draws({.seed = seed,
                          .trial = room.floor.number,
                          .feature = door_place_item,
                          .source = building_draws});
      const bool left = draws.below(2);
      const double from = 0.75 + draws.uniform(0, std::min(0.6, (x1 - x0) / 2 - 0.75));
      room.door_x_m = to_grid(left ? x0 + from : x1 - from);
      room.leg = room_leg(room, plan.size_m.y() / 2);
      plan.rooms.push_back(std::move(room));
    }
  }
  return plan;
}

// The openings of one side of the corridor, as the middles of doors by x.
std::vector<double> doors(const Plan& plan, int window_side) {
  std::vector<double> middles;
  for (const auto& room : plan.rooms) {
    if (room.window_side == window_side) middles.push_back(room.door_x_m);
  }
  return middles;
}

// A line along x, interrupted by `half` on both sides of every door.
void broken_line(Shapes& shapes,
                 double x0,
                 double x1,
                 const std::vector<double>& doors,
                 double half,
                 double y,
                 double z) {
  double from = x0;
  for (const double door : doors) {
    if (door < x0 || door > x1) continue;
    shapes.line({from, y, z}, {door - half, y, z});
    from = door + half;
  }
  shapes.line({from, y, z}, {x1, y, z});
}

// A line along y, interrupted by `half` on both sides of a doorway in the middle.
void end_line(Shapes& shapes, double x, double y0, double y1, double half, bool is_open, double z) {
  if (!is_open) return shapes.line({x, y0, z}, {x, y1, z});
  const double middle = (y0 + y1) / 2;
  shapes.line({x, y0, z}, {x, middle - half, z});
  shapes.line({x, middle + half, z}, {x, y1, z});
}

// The edges of a rectangle of floor, with skirting boards, and of its ceiling.
void draw_shell(Shapes& shapes,
                const Vector3d& low,
                const Vector3d& high,
                const std::vector<double>& low_doors,
                const std::vector<double>& high_doors,
                const OpenEnds& open = {}) {
  const double half = door_width_m / 2, casing = half + casing_m;
  for (const auto& [y, gaps] : {std::pair(low.y(), &low_doors), std::pair(high.y(), &high_doors)}) {
    broken_line(shapes, low.x(), high.x(), *gaps, half, y, 0);
    broken_line(shapes, low.x(), high.x(), *gaps, casing, y, skirting_m);
    shapes.line({low.x(), y, high.z()}, {high.x(), y, high.z()});
  }
  for (const double x : {low.x(), high.x()}) {
    const bool is_open = x == low.x() ? open.low_x : open.high_x;
    end_line(shapes, x, low.y(), high.y(), half, is_open, 0);
    end_line(shapes, x, low.y(), high.y(), casing, is_open, skirting_m);
    shapes.line({x, low.y(), high.z()}, {x, high.y(), high.z()});
    for (const double y : {low.y(), high.y()}) shapes.line({x, y, 0}, {x, y, high.z()});
  }
}

// A wall along the corridor as solid pieces between openings, and lintels above these.
void raise_corridor_wall(Shapes& shapes, const Plan& plan, int window_side) {
  const double y0 = window_side == 0 ? plan.south_m - wall_thickness_m : plan.north_m;
  const double y1 = y0 + wall_thickness_m, height = plan.size_m.z();
  const unsigned faces = front_face | back_face;
  double from = 0;
  for (const double door : doors(plan, window_side)) {
    const double x0 = door - door_width_m / 2, x1 = door + door_width_m / 2;
    shapes.surfaces_of_box({from, y0, 0}, {x0, y1, height}, faces);
    shapes.surfaces_of_box({x0, y0, 0}, {x0, y1, door_height_m}, left_face);
    shapes.surfaces_of_box({x1, y0, 0}, {x1, y1, door_height_m}, left_face);
    shapes.surfaces_of_box({x0, y0, door_height_m}, {x1, y1, height}, faces | bottom_face);
    from = x1;
  }
  shapes.surfaces_of_box({from, y0, 0}, {plan.size_m.x(), y1, height}, faces);
}

void raise_walls(Shapes& shapes, const Plan& plan) {
  const Vector3d& size = plan.size_m;
  // Nothing lies beyond the outer walls, so they are represented by their inner faces.
  raise_outer_walls(shapes, size, plan.open);
  raise_corridor_wall(shapes, plan, 0);
  raise_corridor_wall(shapes, plan, 2);
  for (const auto& room : plan.rooms) {
    if (room.floor.high_m.x() >= size.x()) continue;
    const double x = room.floor.high_m.x();
    shapes.surfaces_of_box({x, room.floor.low_m.y(), 0},
                           {x + wall_thickness_m, room.floor.high_m.y(), size.z()},
                           left_face | right_face);
  }
  for (const auto& room : plan.rooms) {
    const std::vector<double> none, own{room.door_x_m};
    const bool south = room.window_side == 0;
    draw_shell(shapes, room.floor.low_m, room.floor.high_m, south ? none : own, south ? own : none);
  }
  draw_shell(shapes, {0, plan.south_m, 0}, {size.x(), plan.north_m, size.z()}, doors(plan, 0),
             doors(plan, 2), plan.open);
}

// Posters, lockers, notice boards and cartons between the doors, and a closed exit at the far end.
void furnish_corridor_wall(BuildingSite& site, const Plan& plan, int side) {
  const RoomWall wall = site.room().wall(side);
  const double half = door_width_m / 2 + casing_m;
  for (const auto& room : plan.rooms) {
    if (room.window_side != side) continue;
    const double x = side == 0 ? room.door_x_m : plan.size_m.x() - room.door_x_m;
    site.occupy(wall.frame * AlignedBox3d(Vector3d(x - half - 0.02, 0, 0),
                                          Vector3d(x + half + 0.02, 0.6, door_height_m + 0.12)));
    site.try_place("door_sign", wall.frame, {x + half + 0.06, 0, 0});
  }
  RandomStream draws = site.draws(200 + side);
  for (int i = 0; i < static_cast<int>(wall.length_m / 4); ++i) {
    double x = draws.uniform(0.3, wall.length_m - 0.8);
    const int row = 1 + static_cast<int>(draws.below(4));
    for (int k = 0; k < row && draws.uniform() < 0.8; ++k, x += 0.42) {
      if (!site.try_place("locker", wall.frame, {x, 0, 0})) break;
    }
    const double board = draws.uniform(0.1, std::max(0.2, wall.length_m - 1.4));
    if (site.try_place("notice_board", wall.frame, {board, 0, 0})) {
      pin_papers(site, wall.frame, {board + 0.03, 1.18}, {board + 1.17, 1.97}, draws);
    }
    site.try_place("socket", wall.frame, {draws.uniform(0.1, wall.length_m - 0.3), 0, 0});
  }
  run_cables(site, wall, draws);
  hang_pictures(site, wall, static_cast<int>(wall.length_m), draws);
  drop_cartons(site, wall, 3, draws);
}

void fit_window_at_end(BuildingSite& site, double middle) {
  const RoomWall start = site.room().wall(3);
  site.occupy(start.frame *
              AlignedBox3d(Vector3d(middle - 0.85, 0, 0.9), Vector3d(middle + 0.85, 0.2, 2.15)));
  site.place("window", start.frame, {middle - 0.75, 0, 0});
}

void close_exit(BuildingSite& site, double middle) {
  Shapes& loose = site.loose();
  loose.frame = site.room().wall(1).frame;
  for (const double out : {0.0, casing_m}) {
    const double half = door_width_m / 2 + out, top = door_height_m + out;
    loose.line({middle - half, 0.01, 0}, {middle - half, 0.01, top});
    loose.line({middle - half, 0.01, top}, {middle + half, 0.01, top});
    loose.line({middle + half, 0.01, top}, {middle + half, 0.01, 0});
  }
  loose.upright_rectangle(middle - 0.35, 1.02, middle + 0.35, 1.08, 0.02);
  loose.box({middle - 0.2, 0.3, door_height_m + 0.1}, {middle + 0.2, 0.33, door_height_m + 0.22},
            all_faces);
}

void furnish_corridor(BuildingSite& site, const Plan& plan) {
  const double width = plan.north_m - plan.south_m, middle = width / 2;
  if (width > 1.7 && !plan.open.low_x) fit_window_at_end(site, middle);
  if (plan.open.high_x) {
    site.place("door_frame", site.room().wall(1).frame, {middle, 0, 0});
  } else {
    close_exit(site, middle);
  }
  furnish_corridor_wall(site, plan, 0);
  furnish_corridor_wall(site, plan, 2);
  const int lights = std::max(1, static_cast<int>(std::round(plan.size_m.x() / 2.5)));
  for (int i = 0; i < lights; ++i) {
    const double x = (i + 0.5) * plan.size_m.x() / lights;
    site.place("ceiling_light", {{x, plan.size_m.y() / 2, plan.size_m.z()}, 0}, Vector3d::Zero());
  }
}

}  // namespace

WorldDescription make_office(std::uint64_t seed, const OfficeOptions& options) {
  check_options(options);
  const Plan plan = make_plan(seed, options);
  BuildingSite site(seed);
  raise_walls(site.loose(), plan);

  const double middle = to_grid(plan.size_m.y() / 2), length = plan.size_m.x();
  const double from = plan.open.low_x ? 0 : route_end_m;
  const double to = plan.open.high_x ? length + wall_thickness_m : length - route_end_m;
  std::vector<RouteLeg> route{{{{from, middle}, {to, middle}}}};
  const RectangularRoom corridor{
      corridor_number, {0, plan.south_m, 0}, {length, plan.north_m, plan.size_m.z()}};
  site.enter(corridor, route[0].points_m);
  furnish_corridor(site, plan);

  for (const auto& room : plan.rooms) {
    site.enter(room.floor, room.leg.points_m);
    const int door_side = (room.window_side + 2) % 4;
    const RoomWall wall = room.floor.wall(door_side);
    const double door_x = door_side == 0 ? room.door_x_m - room.floor.low_m.x()
                                         : room.floor.high_m.x() - room.door_x_m;
    site.place("door_frame", wall.frame, {door_x, 0, 0});
    furnish_room(site, room.window_side, door_x);
    route.push_back(room.leg);
  }
  WorldDescription world = site.finish();
  world.name = "office-" + std::to_string(seed);
  world.route = std::move(route);
  return world;
}

}  // namespace vernier::sim::internal
