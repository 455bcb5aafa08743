// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/home.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/home_furniture.h"
#include "sim/buildings/home_room.h"
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

constexpr double least_side_m = 2.3;      ///< of a room, walls included
constexpr double shared_wall_m = 1.4;     ///< that two rooms need for a door
constexpr double more_doors = 0.25;       ///< share of the other shared walls that have one too
constexpr std::uint32_t plan_number = 0;  ///< rooms count from 1
constexpr double front_of_door_m = 0.55;  ///< where the route turns towards the middle

struct HomeRoom {
  AlignedBox2d floor;  ///< between the inner faces of its walls
  std::vector<HomeWall> walls;
  std::vector<FloorPath> paths;
  Vector2d middle() const { return {to_grid(floor.center().x()), to_grid(floor.center().y())}; }
};

/// A stretch of wall between two rooms: side `wall` of `a` and the opposite one of `b`.
struct SharedWall {
  std::size_t a = 0, b = 0;
  int side = 0;
  double from_m = 0, to_m = 0;  ///< world coordinate along it
};

// Cuts a rectangle of floor across its longer side until it is a room.
void cut(const AlignedBox2d& floor,
         const Vector3d& size,
         const OpenEnds& open,
         RandomStream& draws,
         std::vector<AlignedBox2d>& rooms) {
  const Vector2d sides = floor.sizes();
  const int axis = sides.x() >= sides.y() ? 0 : 1;
  const double largest = draws.uniform(8, 22), share = draws.uniform(0.36, 0.64);
  if (floor.volume() <= largest || sides[axis] < 2 * least_side_m) return rooms.push_back(floor);
  double at = floor.min()[axis] + share * sides[axis];
  at = std::clamp(at, floor.min()[axis] + least_side_m, floor.max()[axis] - least_side_m);
  // A wall must not end in the doorway to the next part of the building.
  const bool at_doorway = axis == 1 && ((open.low_x && floor.min().x() == 0) ||
                                        (open.high_x && floor.max().x() == size.x()));
  if (at_doorway && std::abs(at - size.y() / 2) < 0.8) {
    const double below = size.y() / 2 - 0.8, above = size.y() / 2 + 0.8;
    if (below - floor.min().y() >= least_side_m) {
      at = below;
    } else if (floor.max().y() - above >= least_side_m) {
      at = above;
    } else {
      return rooms.push_back(floor);
    }
  }
  AlignedBox2d low = floor, high = floor;
  low.max()[axis] = high.min()[axis] = to_grid(at);
  cut(low, size, open, draws, rooms);
  cut(high, size, open, draws, rooms);
}

// Half of an inner wall's thickness belongs to either room.
AlignedBox2d inside(AlignedBox2d floor, const Vector3d& size) {
  for (int axis = 0; axis < 2; ++axis) {
    if (floor.min()[axis] > 0)
      floor.min()[axis] = to_grid(floor.min()[axis] + wall_thickness_m / 2);
    if (floor.max()[axis] < size[axis]) {
      floor.max()[axis] = to_grid(floor.max()[axis] - wall_thickness_m / 2);
    }
  }
  return floor;
}

std::vector<SharedWall> shared_walls(const std::vector<HomeRoom>& rooms) {
  std::vector<SharedWall> shared;
  for (std::size_t a = 0; a < rooms.size(); ++a) {
    for (std::size_t b = 0; b < rooms.size(); ++b) {
      for (const int axis : {0, 1}) {
        const double gap = rooms[b].floor.min()[axis] - rooms[a].floor.max()[axis];
        if (std::abs(gap - wall_thickness_m) > 1e-6) continue;
        const int along = 1 - axis;
        const double from = std::max(rooms[a].floor.min()[along], rooms[b].floor.min()[along]);
        const double to = std::min(rooms[a].floor.max()[along], rooms[b].floor.max()[along]);
        if (to - from >= shared_wall_m) shared.push_back({a, b, axis == 0 ? 1 : 2, from, to});
      }
    }
  }
  return shared;
}

// Place of a world coordinate along a wall.
double along_wall(const RoomWall& wall, double coordinate) {
  const Vector3d& origin = wall.frame.origin_m;
  switch (wall.frame.quarters) {
    case 0:
      return to_grid(coordinate - origin.x());
    case 1:
      return to_grid(coordinate - origin.y());
    case 2:
      return to_grid(origin.x() - coordinate);
    default:
      return to_grid(origin.y() - coordinate);
  }
}

Vector2d before(const RoomWall& wall, double along_m, double out_m) {
  const Vector3d at = wall.frame * Vector3d(along_m, out_m, 0);
  return {to_grid(at.x()), to_grid(at.y())};
}

// A doorway between two rooms, and the leg of the route through it.
RouteLeg open_door(std::vector<HomeRoom>& rooms, const SharedWall& shared, RandomStream& draws) {
  const double at =
      to_grid(draws.uniform(shared.from_m + shared_wall_m / 2, shared.to_m - shared_wall_m / 2));
  RouteLeg leg;
  leg.points_m.push_back(rooms[shared.a].middle());
  for (const bool second : {false, true}) {
    HomeRoom& room = rooms[second ? shared.b : shared.a];
    const int side = second ? (shared.side + 2) % 4 : shared.side;
    HomeWall& wall = room.walls[side];
    const double along = along_wall(wall.wall, at);
    wall.openings.push_back({static_cast<std::size_t>(side), along});
    const Vector2d front = before(wall.wall, along, front_of_door_m);
    room.paths.push_back({room.middle(), front, before(wall.wall, along, 0)});
    leg.points_m.push_back(front);
  }
  leg.points_m.push_back(rooms[shared.b].middle());
  return leg;
}

// Doors as a tree that reaches every room (Prim, with drawn weights), and some more; their legs in
// the order in which the tree grew.
std::vector<RouteLeg> open_doors(std::vector<HomeRoom>& rooms, RandomStream& draws) {
  std::vector<SharedWall> shared = shared_walls(rooms);
  std::vector<double> weights(shared.size());
  for (double& weight : weights) weight = draws.uniform();
  std::vector<bool> reached(rooms.size());
  std::vector<bool> used(shared.size());
  std::vector<RouteLeg> legs;
  reached[0] = true;
  while (true) {
    std::size_t best = shared.size();
    for (std::size_t i = 0; i < shared.size(); ++i) {
      if (reached[shared[i].a] == reached[shared[i].b]) continue;
      if (best == shared.size() || weights[i] < weights[best]) best = i;
    }
    if (best == shared.size()) break;
    reached[shared[best].a] = reached[shared[best].b] = used[best] = true;
    legs.push_back(open_door(rooms, shared[best], draws));
  }
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (draws.uniform() < more_doors && !used[i]) {
      legs.push_back(open_door(rooms, shared[i], draws));
    }
  }
  return legs;
}

std::vector<HomeRoomUse> uses_of(const std::vector<HomeRoom>& rooms, RandomStream& draws) {
  std::vector<std::size_t> by_area(rooms.size());
  std::iota(by_area.begin(), by_area.end(), 0);
  std::stable_sort(by_area.begin(), by_area.end(), [&](std::size_t a, std::size_t b) {
    return rooms[a].floor.volume() > rooms[b].floor.volume();
  });
  const std::size_t count = rooms.size();
  const std::size_t baths = count < 3 ? 0 : (count + 3) / 6;
  std::vector<HomeRoomUse> uses(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double kind = draws.uniform();
    HomeRoomUse use = kind < 0.55   ? HomeRoomUse::bedroom
                      : kind < 0.75 ? HomeRoomUse::study
                      : kind < 0.9  ? HomeRoomUse::living
                                    : HomeRoomUse::kitchen;
    if (i == 0) use = HomeRoomUse::living;
    if (i == 1) use = HomeRoomUse::kitchen;
    if (i + baths >= count) use = HomeRoomUse::bathroom;
    uses[by_area[i]] = use;
  }
  return uses;
}

std::vector<HomeRoom> lay_out(const HomeOptions& options,
                              const Vector3d& size,
                              RandomStream& draws) {
  std::vector<AlignedBox2d> floors;
  cut({Vector2d::Zero(), Vector2d(size.head<2>())}, size, options.open, draws, floors);
  std::vector<HomeRoom> rooms;
  for (const AlignedBox2d& floor : floors) {
    HomeRoom room;
    room.floor = inside(floor, size);
    const RectangularRoom box{0,
                              {room.floor.min().x(), room.floor.min().y(), 0},
                              {room.floor.max().x(), room.floor.max().y(), size.z()}};
    const std::array<bool, 4> outer{floor.min().y() == 0, floor.max().x() == size.x(),
                                    floor.max().y() == size.y(), floor.min().x() == 0};
    for (int side = 0; side < 4; ++side) room.walls.push_back({box.wall(side), outer[side], {}});
    rooms.push_back(std::move(room));
  }
  return rooms;
}

// The doorways to the next parts, with a leg from the room's middle to each.
void open_ends(std::vector<HomeRoom>& rooms,
               const HomeOptions& options,
               const Vector3d& size,
               std::vector<RouteLeg>& route) {
  for (HomeRoom& room : rooms) {
    std::vector<RoomWall> walls;
    for (const HomeWall& wall : room.walls) walls.push_back(wall.wall);
    for (const Opening& opening : end_openings(walls, size, options.open)) {
      HomeWall& wall = room.walls[opening.wall];
      wall.openings.push_back(opening);
      const FloorPath path{room.middle(), before(wall.wall, opening.middle_m, front_of_door_m),
                           before(wall.wall, opening.middle_m, 0)};
      room.paths.push_back(path);
      route.push_back({path});
    }
  }
}

// A home of one room has no door to drive through.
void cross_room(HomeRoom& room, std::vector<RouteLeg>& route) {
  const Vector2d sides = room.floor.sizes(), middle = room.middle();
  const int axis = sides.x() >= sides.y() ? 0 : 1;
  FloorPath path{middle, middle};
  path[0][axis] = to_grid(room.floor.min()[axis] + 0.6);
  path[1][axis] = to_grid(room.floor.max()[axis] - 0.6);
  room.paths.push_back(path);
  route.push_back({path});
}

void check_home(const Vector3d& size) {
  const auto refuse = [](const std::string& fault, const std::string& remedy) {
    throw Error("home", fault, remedy);
  };
  if (!size.allFinite()) refuse("a size is not finite", "use finite lengths in metres");
  if (size.maxCoeff() > 200) refuse("a length is above 200 m", "use at most 200 m");
  if (size.z() < 2.3)
    refuse("the height is below 2.3 m", "use at least 2.3 m, for the door frames");
  if (size.head<2>().minCoeff() < 3) refuse("no room fits", "use at least 3 m each way");
}

void raise_home(BuildingSite& site, const std::vector<HomeRoom>& rooms, double height) {
  for (const HomeRoom& room : rooms) {
    std::vector<RoomWall> walls;
    std::vector<Opening> openings;
    for (const HomeWall& wall : room.walls) {
      walls.push_back(wall.wall);
      openings.insert(openings.end(), wall.openings.begin(), wall.openings.end());
    }
    raise_room(site.loose(), {room.floor}, walls, height, openings);
    // Sides 1 and 2 of a room are sides 3 and 0 of its neighbour, or lead to the next part.
    for (const int side : {1, 2}) {
      for (const Opening& opening : room.walls[side].openings) {
        raise_reveals(site.loose(), room.walls[side].wall, opening);
        site.place("door_frame", room.walls[side].wall.frame, {opening.middle_m, 0, 0});
      }
    }
  }
}

}  // namespace

WorldDescription make_home(std::uint64_t seed, const HomeOptions& options) {
  check_home(options.size_m);
  const Vector3d size = to_grid(options.size_m);
  RandomStream draws({.seed = seed, .trial = plan_number, .source = building_draws});
  std::vector<HomeRoom> rooms = lay_out(options, size, draws);
  std::vector<RouteLeg> route = open_doors(rooms, draws);
  open_ends(rooms, options, size, route);
  if (route.empty()) cross_room(rooms[0], route);
  const std::vector<HomeRoomUse> uses = uses_of(rooms, draws);

  BuildingSite site(seed);
  for (const WorldTemplate& entry : home_templates()) site.define(entry);
  raise_home(site, rooms, size.z());
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    const AlignedBox2d& floor = rooms[i].floor;
    const AlignedBox3d box(Vector3d(floor.min().x(), floor.min().y(), 0),
                           Vector3d(floor.max().x(), floor.max().y(), size.z()));
    site.enter(static_cast<std::uint32_t>(i + 1), {box}, rooms[i].paths);
    furnish_home_room(site, uses[i], rooms[i].walls);
  }
  WorldDescription world = site.finish();
  world.name = "home-" + std::to_string(seed);
  world.route = std::move(route);
  return world;
}

}  // namespace vernier::sim::internal
