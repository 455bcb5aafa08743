// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/home_room.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/home_furniture.h"
#include "sim/buildings/office_clutter.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/space.h"
#include "sim/buildings/wire_shapes.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Keys of draws, with steps for the walls of a room.
enum HomeItem : std::uint32_t {
  home_window_item = 400,
  home_door_item = 420,
  home_piece_item = 440,
  home_light_item = 500,
  home_picture_item = 520,
  home_socket_item = 540,
  home_carton_item = 560,
};

struct Placed {
  QuarterFrame frame;
  double x_m = 0;
};

double width_of(const BuildingSite& site, const std::string& name) {
  return site.taken(name, {}, Vector3d::Zero()).max().x();
}

// At a drawn place of a drawn wall, if one of `tries` is free.
std::optional<Placed> stand_at_wall(BuildingSite& site,
                                    const std::vector<HomeWall>& walls,
                                    const std::string& name,
                                    RandomStream& draws,
                                    int tries = 16) {
  const double width = width_of(site, name);
  for (int i = 0; i < tries; ++i) {
    const RoomWall& wall = walls[draws.below(static_cast<std::uint32_t>(walls.size()))].wall;
    const double x = draws.uniform(0.03, std::max(0.04, wall.length_m - width - 0.03));
    if (site.try_place(name, wall.frame, {x, 0, 0})) return Placed{wall.frame, x};
  }
  return std::nullopt;
}

// Something round its centre, away from the walls.
std::optional<Vector3d> stand_free(BuildingSite& site,
                                   const std::string& name,
                                   int quarters,
                                   RandomStream& draws,
                                   int tries = 16) {
  const Vector3d low = site.room().low_m, high = site.room().high_m;
  for (int i = 0; i < tries; ++i) {
    const Vector3d at{draws.uniform(low.x(), high.x()), draws.uniform(low.y(), high.y()), 0};
    const QuarterFrame frame{at, quarters};
    AlignedBox3d box = frame * site.taken(name, {}, Vector3d::Zero());
    // taken() reaches to a wall at y = 0; what stands free has its own box around it.
    const AlignedBox3d mirrored =
        QuarterFrame{at, quarters + 2} * site.taken(name, {}, Vector3d::Zero());
    box.extend(mirrored);
    if (!site.is_free(box)) continue;
    site.occupy(box);
    site.place(name, frame, Vector3d::Zero());
    return at;
  }
  return std::nullopt;
}

void open_home_windows(BuildingSite& site, const HomeWall& wall, std::uint32_t number) {
  RandomStream draws = site.draws(home_window_item + number);
  const int windows = static_cast<int>(wall.wall.length_m / 2.4);
  const double share = wall.wall.length_m / std::max(windows, 1);
  for (int i = 0; i < windows; ++i) {
    const double x = i * share + 0.1 + draws.uniform(0.1, 0.9) * std::max(0.0, share - 1.8);
    const bool is_there = draws.uniform() < 0.8, heated = draws.uniform() < 0.6;
    const AlignedBox3d pane(Vector3d(x - 0.06, 0, 0.9), Vector3d(x + 1.56, 0.2, 2.12));
    if (!is_there || !site.is_free(wall.wall.frame * pane)) continue;
    site.occupy(wall.wall.frame * pane);
    site.place("window", wall.wall.frame, {x, 0, 0});
    if (heated) site.try_place("radiator", wall.wall.frame, {x + draws.uniform(0, 0.25), 0, 0});
  }
}

void hang_home_doors(BuildingSite& site, const HomeWall& wall, std::uint32_t number) {
  RandomStream draws = site.draws(home_door_item + number);
  for (const Opening& opening : wall.openings) {
    const double half = opening.width_m / 2 + casing_m + 0.02;
    site.occupy(wall.wall.frame *
                AlignedBox3d(Vector3d(opening.middle_m - half, 0, 0),
                             Vector3d(opening.middle_m + half, 0.8, opening.height_m + 0.15)));
  }
  for (const Opening& opening : wall.openings) {
    const double half = opening.width_m / 2 + casing_m + 0.02;
    const bool right = draws.below(2), has_leaf = draws.uniform() < 0.4;
    const RoomWall& at = wall.wall;
    const double beside = right ? opening.middle_m + half + 0.02 : opening.middle_m - half - 0.91;
    if (has_leaf) {
      site.try_place(right ? "door_leaf_right" : "door_leaf_left", at.frame, {beside, 0, 0});
    }
    site.try_place("light_switch", at.frame,
                   {right ? opening.middle_m - half - 0.13 : opening.middle_m + half + 0.05, 0, 0});
  }
}

// A row of kitchen units with cabinets above, along the wall that holds the longest.
void fit_kitchen(BuildingSite& site, const std::vector<HomeWall>& walls, RandomStream& draws) {
  constexpr double pitch_m = 0.62;
  const RoomWall* best = nullptr;
  double from = 0;
  int most = 0;
  for (const HomeWall& candidate : walls) {
    const RoomWall& wall = candidate.wall;
    const double start = draws.uniform(0.03, 0.3);
    int free = 0;
    for (double x = start; x + pitch_m < wall.length_m; x += pitch_m) {
      const bool fits = site.is_free(site.taken("kitchen_unit", wall.frame, {x, 0, 0}));
      free = fits ? free + 1 : 0;
      if (free <= most) continue;
      most = free;
      best = &wall;
      from = x - (free - 1) * pitch_m;
    }
  }
  most = std::min(most, 6);
  for (int k = 0; k < most; ++k) {
    const double x = from + k * pitch_m;
    const char* name = k == 1                  ? "kitchen_sink"
                       : k == 3                ? "kitchen_stove"
                       : draws.uniform() < 0.5 ? "kitchen_unit"
                                               : "kitchen_drawers";
    site.try_place(name, best->frame, {x, 0, 0});
    if (draws.uniform() < 0.75) site.try_place("wall_cabinet", best->frame, {x, 0, 0});
    if (k != 1 && k != 3) {
      litter_top(site, best->frame, {x + 0.03, 0.05, worktop_m}, {0.5, 0.4}, 1, draws);
    }
  }
  stand_at_wall(site, walls, "fridge", draws);
}

void lay_table(BuildingSite& site, RandomStream& draws) {
  const int quarters = static_cast<int>(draws.below(2));
  const auto table = stand_free(site, "dining_table", quarters, draws, 30);
  if (!table) return;
  const QuarterFrame frame{*table, quarters};
  litter_top(site, frame, {-0.6, -0.35, 0.75}, {1.2, 0.7}, 3, draws);
  for (const double x : {-0.35, 0.35}) {
    for (const int side : {-1, 1}) {
      const double out = draws.uniform(0.66, 0.8);
      const int yaw = static_cast<int>(draws.below(41)) - 20;
      const AlignedBox3d box(Vector3d(x - 0.3, side * out - 0.22, 0),
                             Vector3d(x + 0.3, side * out + 0.22, 0.95));
      if (!site.is_free(frame * box)) continue;
      site.occupy(frame * box);
      site.place("dining_chair", frame, {x, side * out, 0}, yaw + (side > 0 ? 0 : 180));
    }
  }
}

void fill_shelves(BuildingSite& site, const std::vector<HomeWall>& walls, RandomStream& draws) {
  const int shelves = 1 + static_cast<int>(draws.below(3));
  for (int i = 0; i < shelves; ++i) {
    const auto shelf = stand_at_wall(site, walls, "bookshelf", draws, 8);
    if (shelf) fill_bookshelf(site, shelf->frame, shelf->x_m, draws);
  }
}

void put_on_top(BuildingSite& site,
                const std::vector<HomeWall>& walls,
                const std::string& name,
                double top_m,
                const Vector2d& size_m,
                RandomStream& draws) {
  const auto at = stand_at_wall(site, walls, name, draws);
  if (!at) return;
  litter_top(site, at->frame, {at->x_m + 0.03, 0.06, top_m}, size_m,
             1 + static_cast<int>(draws.below(4)), draws);
}

void furnish_living(BuildingSite& site, const std::vector<HomeWall>& walls, RandomStream& draws) {
  stand_at_wall(site, walls, "television", draws, 24);
  stand_at_wall(site, walls, "sofa", draws, 24);
  if (draws.below(2)) stand_at_wall(site, walls, "armchair", draws);
  const int quarters = static_cast<int>(draws.below(2));
  const auto table = stand_free(site, "coffee_table", quarters, draws);
  if (table) litter_top(site, {*table, quarters}, {-0.5, -0.25, 0.42}, {1.0, 0.5}, 2, draws);
  fill_shelves(site, walls, draws);
  put_on_top(site, walls, "sideboard", 0.78, {1.1, 0.35}, draws);
  if (draws.below(2)) lay_table(site, draws);
  stand_free(site, "floor_lamp", 0, draws);
  stand_free(site, "potted_plant", static_cast<int>(draws.below(4)), draws);
}

void furnish_bedroom(BuildingSite& site, const std::vector<HomeWall>& walls, RandomStream& draws) {
  const bool is_double = draws.uniform() < 0.6;
  const char* bed = is_double ? "double_bed" : "single_bed";
  const double width = width_of(site, bed);
  const auto at = stand_at_wall(site, walls, bed, draws, 40);
  if (at) {
    site.try_place("night_table", at->frame, {at->x_m - 0.5, 0, 0});
    site.try_place("night_table", at->frame, {at->x_m + width + 0.05, 0, 0});
  }
  const int wardrobes = 1 + static_cast<int>(draws.below(3));
  const auto first = stand_at_wall(site, walls, "wardrobe", draws, 24);
  for (int i = 1; first && i < wardrobes; ++i) {
    site.try_place("wardrobe", first->frame, {first->x_m + 1.02 * i, 0, 0});
  }
  put_on_top(site, walls, "dresser", 0.86, {0.9, 0.36}, draws);
  if (draws.below(2)) fill_shelves(site, walls, draws);
  if (draws.below(2)) stand_free(site, "potted_plant", static_cast<int>(draws.below(4)), draws);
}

void furnish_bathroom(BuildingSite& site, const std::vector<HomeWall>& walls, RandomStream& draws) {
  for (const char* name : {"bathtub", "washbasin", "toilet", "towel_rail", "washbasin"}) {
    stand_at_wall(site, walls, name, draws, 24);
  }
}

void furnish_study(BuildingSite& site, const std::vector<HomeWall>& walls, RandomStream& draws) {
  const auto desk = stand_at_wall(site, walls, "desk", draws, 24);
  if (desk) {
    site.place("monitor", desk->frame, {desk->x_m + draws.uniform(0.4, 1.2), 0.25, 0.74});
    litter_top(site, desk->frame, {desk->x_m + 0.03, 0.4, 0.74}, {1.5, 0.35}, 3, draws);
    site.place("pedestal", desk->frame, {desk->x_m + 1.09, 0, 0});
    const Vector3d seat{desk->x_m + 0.6, draws.uniform(1.05, 1.2), 0};
    const AlignedBox3d box(seat - Vector3d(0.33, 0.24, 0), seat + Vector3d(0.33, 0.33, 1));
    if (site.is_free(desk->frame * box)) {
      site.occupy(desk->frame * box);
      site.place("office_chair", desk->frame, seat, static_cast<int>(draws.below(71)) - 35);
    }
  }
  fill_shelves(site, walls, draws);
  put_on_top(site, walls, "sideboard", 0.78, {1.1, 0.35}, draws);
  if (draws.below(2)) stand_at_wall(site, walls, "armchair", draws);
}

void furnish_for(BuildingSite& site, HomeRoomUse use, const std::vector<HomeWall>& walls) {
  RandomStream draws = site.draws(home_piece_item);
  switch (use) {
    case HomeRoomUse::living:
      return furnish_living(site, walls, draws);
    case HomeRoomUse::kitchen:
      fit_kitchen(site, walls, draws);
      return lay_table(site, draws);
    case HomeRoomUse::bedroom:
      return furnish_bedroom(site, walls, draws);
    case HomeRoomUse::bathroom:
      return furnish_bathroom(site, walls, draws);
    case HomeRoomUse::study:
      return furnish_study(site, walls, draws);
  }
}

}  // namespace

void furnish_home_room(BuildingSite& site, HomeRoomUse use, const std::vector<HomeWall>& walls) {
  const auto count = static_cast<std::uint32_t>(walls.size());
  for (std::uint32_t i = 0; i < count; ++i) hang_home_doors(site, walls[i], i);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (walls[i].is_outer) open_home_windows(site, walls[i], i);
  }
  furnish_for(site, use, walls);
  RandomStream lights = site.draws(home_light_item);
  const Vector3d low = site.room().low_m, high = site.room().high_m, middle = (low + high) / 2;
  site.place(
      use == HomeRoomUse::kitchen || use == HomeRoomUse::bathroom ? "ceiling_light"
                                                                  : "pendant_lamp",
      {{middle.x() + lights.uniform(-0.2, 0.2), middle.y() + lights.uniform(-0.2, 0.2), high.z()},
       static_cast<int>(lights.below(2))},
      Vector3d::Zero());
  if (use == HomeRoomUse::living || use == HomeRoomUse::bedroom) {
    if (lights.below(2)) {
      site.place("rug", {{middle.x(), middle.y(), 0}, static_cast<int>(lights.below(2))},
                 Vector3d::Zero());
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const RoomWall& wall = walls[i].wall;
    RandomStream pictures = site.draws(home_picture_item + i);
    if (use != HomeRoomUse::bathroom) {
      hang_pictures(site, wall, static_cast<int>(wall.length_m * 0.8), pictures);
    }
    RandomStream sockets = site.draws(home_socket_item + i);
    for (int k = 0; k < 1 + static_cast<int>(wall.length_m / 3); ++k) {
      site.try_place("socket", wall.frame, {sockets.uniform(0.1, wall.length_m - 0.3), 0, 0});
    }
    RandomStream cartons = site.draws(home_carton_item + i);
    if (cartons.uniform() < 0.3) drop_cartons(site, wall, 1, cartons);
  }
}

}  // namespace vernier::sim::internal
