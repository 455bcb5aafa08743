// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/office_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "calib/statistics/random.h"
#include "sim/buildings/building_site.h"
#include "sim/buildings/office_clutter.h"
#include "sim/buildings/office_furniture.h"
#include "sim/buildings/wire_shapes.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Keys of draws. Every item has its own, so that changing one leaves the rest of the room
// unchanged.
enum Item : std::uint32_t {
  style_item = 0,
  window_item = 1,
  door_item = 2,
  light_item = 3,
  socket_item = 10,
  board_item = 20,
  cable_item = 30,
  picture_item = 40,
  carton_item = 50,
  wall_item = 1000,  ///< + 1000 · wall + place along the wall
};

/// Relative frequency of each kind of furniture in rooms of one style.
struct Style {
  std::array<double, 8> weights;
};

namespace furniture {
enum Kind { desk, table, shelf, cupboard, sideboard, filing, locker, nothing };
}  // namespace furniture

constexpr std::array<const char*, 7> furniture_names{
    "desk", "table", "bookshelf", "cupboard", "sideboard", "filing_cabinet", "locker"};

constexpr std::array<Style, 4> styles{{
    {{5, 0, 2, 1, 1, 1, 0, 3}},  // study
    {{2, 1, 5, 2, 1, 2, 0, 3}},  // archive
    {{2, 3, 2, 1, 2, 0, 0, 5}},  // meeting
    {{4, 2, 2, 2, 0, 1, 2, 4}},  // laboratory
}};

int draw_furniture(const Style& style, RandomStream& draws) {
  double total = 0;
  for (const double weight : style.weights) total += weight;
  double rest = draws.uniform(0, total);
  for (int kind = 0; kind < furniture::nothing; ++kind) {
    rest -= style.weights[kind];
    if (rest < 0) return kind;
  }
  return furniture::nothing;
}

// A chair turns within its circle; it may reach below the board in front of it.
void place_chair(BuildingSite& site,
                 const char* name,
                 const QuarterFrame& frame,
                 const Vector2d& middle,
                 double board_depth,
                 RandomStream& draws) {
  const double radius = 0.33, back = std::max(middle.y() - radius, board_depth + 0.016);
  const AlignedBox3d box(Vector3d(middle.x() - radius, back, 0),
                         Vector3d(middle.x() + radius, middle.y() + radius, 1));
  const int yaw_deg = static_cast<int>(draws.below(71)) - 35;
  if (!site.is_free(frame * box)) return;
  site.occupy(frame * box);
  site.place(name, frame, {middle.x(), middle.y(), 0}, yaw_deg);
}

void equip_desk(BuildingSite& site, const QuarterFrame& frame, double x, RandomStream& draws) {
  const double seat = x + draws.uniform(0.55, 0.95);
  const int screens = 1 + static_cast<int>(draws.below(2));
  for (int i = 0; i < screens; ++i) {
    const double at = seat + (screens == 2 ? 0.62 * i - 0.31 : draws.uniform(-0.1, 0.1));
    const double y = draws.uniform(0.18, 0.26);
    const double inside = std::clamp(at, x + 0.28, x + 1.32);
    const AlignedBox3d box(Vector3d(inside - 0.28, y - 0.11, board_top_m),
                           Vector3d(inside + 0.28, y + 0.11, board_top_m + 0.45));
    if (!site.is_free(frame * box)) continue;
    site.occupy(frame * box);
    site.place("monitor", frame, {inside, y, board_top_m});
  }
  const double keys = seat + draws.uniform(-0.08, 0.08), keys_y = draws.uniform(0.52, 0.64);
  const AlignedBox3d box(Vector3d(keys - 0.23, keys_y - 0.08, board_top_m),
                         Vector3d(keys + 0.23, keys_y + 0.08, board_top_m + 0.02));
  if (site.is_free(frame * box)) {
    site.occupy(frame * box);
    site.place("keyboard", frame, {keys, keys_y, board_top_m});
  }
  const double side = draws.uniform();
  if (side < 0.7) site.place("pedestal", frame, {x + (side < 0.35 ? 0.09 : 1.09), 0, 0});
  const double pull = draws.uniform(0.86, 1.0);
  place_chair(site, "office_chair", frame, {seat, pull}, 0.8, draws);
  const int things = 1 + static_cast<int>(draws.below(4));
  litter_top(site, frame, {x + 0.03, 0.05, board_top_m}, {1.54, 0.7}, things, draws);
  if (draws.below(2)) site.try_place("bin", frame, {x - 0.2, draws.uniform(0.2, 0.5), 0});
}

void equip_table(BuildingSite& site, const QuarterFrame& frame, double x, RandomStream& draws) {
  const int chairs = 1 + static_cast<int>(draws.below(2));
  for (int i = 0; i < chairs; ++i) {
    const double at = x + (chairs == 1 ? 0.6 : 0.26 + 0.68 * i) + draws.uniform(-0.03, 0.03);
    const double pull = draws.uniform(0.8, 0.95);
    place_chair(site, "visitor_chair", frame, {at, pull}, 0.72, draws);
  }
  const int things = static_cast<int>(draws.below(4));
  litter_top(site, frame, {x + 0.03, 0.05, board_top_m}, {1.14, 0.62}, things, draws);
}

void equip(BuildingSite& site, int kind, const QuarterFrame& frame, double x, RandomStream& draws) {
  switch (kind) {
    case furniture::desk:
      return equip_desk(site, frame, x, draws);
    case furniture::table:
      return equip_table(site, frame, x, draws);
    case furniture::shelf:
      fill_bookshelf(site, frame, x, draws);
      return stack_cartons(site, frame, {x, 0.04, 2.0}, {0.9, 0.26}, draws);
    case furniture::cupboard:
      return stack_cartons(site, frame, {x, 0.04, 1.8}, {1.0, 0.4}, draws);
    case furniture::sideboard:
      return litter_top(site, frame, {x + 0.02, 0.05, 0.78}, {1.16, 0.38}, 3, draws);
    case furniture::filing:
      return litter_top(site, frame, {x + 0.02, 0.05, 1.32}, {0.42, 0.54}, 2, draws);
    default:
      return;
  }
}

void furnish_wall(BuildingSite& site, int side, const Style& style) {
  const RoomWall wall = site.room().wall(side);
  std::uint32_t item = wall_item + 1000 * side;
  double x = site.draws(item).uniform(0.03, 0.5);
  while (x < wall.length_m) {
    RandomStream draws = site.draws(++item);
    const int kind = draw_furniture(style, draws);
    const double gap = draws.uniform() < 0.4 ? draws.uniform(0.02, 0.06) : draws.uniform(0.2, 1.3);
    if (kind == furniture::nothing) {
      x += 0.3 + gap;
      continue;
    }
    const char* name = furniture_names[kind];
    const double width = site.taken(name, {}, Vector3d::Zero()).max().x();
    if (!site.try_place(name, wall.frame, {x, 0, 0})) {
      x += 0.2;
      continue;
    }
    equip(site, kind, wall.frame, x, draws);
    x += width + gap;
  }
}

void open_windows(BuildingSite& site, const RoomWall& wall) {
  RandomStream draws = site.draws(window_item);
  const int windows = std::max(1, static_cast<int>(std::floor(wall.length_m / 3.2)));
  const double share = wall.length_m / windows;
  for (int i = 0; i < windows; ++i) {
    const double slack = std::max(0.0, share - 1.8);
    const double x = i * share + 0.15 + draws.uniform(0.15, 0.85) * slack;
    const AlignedBox3d pane(Vector3d(x - 0.06, 0, 0.9), Vector3d(x + 1.56, 0.3, 2.12));
    if (!site.is_free(wall.frame * pane)) continue;
    site.occupy(wall.frame * pane);
    site.place("window", wall.frame, {x, 0, 0});
    const double under = x + draws.uniform(-0.1, 0.35);
    site.try_place("radiator", wall.frame, {std::clamp(under, 0.05, wall.length_m - 1.35), 0, 0});
  }
}

void fit_ceiling(BuildingSite& site) {
  RandomStream draws = site.draws(light_item);
  const Vector3d low = site.room().low_m, size = site.room().high_m - low;
  const bool across = draws.below(2);
  const int columns = std::max(1, static_cast<int>(std::round(size.x() / 2)));
  const int rows = std::max(1, static_cast<int>(std::round(size.y() / 3.2)));
  const double shift = draws.uniform(-0.25, 0.25);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const QuarterFrame frame{{low.x() + (column + 0.5) * size.x() / columns,
                                low.y() + (row + 0.5) * size.y() / rows + shift, size.z()},
                               across ? 1 : 0};
      site.place("ceiling_light", frame, Vector3d::Zero());
    }
  }
  const double x = low.x() + size.x() * 0.5;
  const double y = low.y() + size.y() / rows * (1 + draws.below(std::max(1, rows - 1))) + shift;
  if (rows > 1) site.place("ceiling_vent", {{x, y, size.z()}, 0}, Vector3d::Zero());
}

// The leaf beside the opening, on the side with more wall, and the switch on the other.
void hang_door(BuildingSite& site, const RoomWall& wall, double door_x) {
  RandomStream draws = site.draws(door_item);
  const double half = door_width_m / 2 + casing_m + 0.02;
  site.occupy(wall.frame * AlignedBox3d(Vector3d(door_x - half, 0, 0),
                                        Vector3d(door_x + half, 0.8, door_height_m + 0.15)));
  const bool leaf_right = door_x < wall.length_m / 2;
  if (draws.uniform() < 0.7) {
    site.try_place(leaf_right ? "door_leaf_right" : "door_leaf_left", wall.frame,
                   {leaf_right ? door_x + half + 0.02 : door_x - half - 0.91, 0, 0});
  }
  site.try_place("light_switch", wall.frame,
                 {leaf_right ? door_x - half - 0.13 : door_x + half + 0.05, 0, 0});
}

void mount_boards(BuildingSite& site, int side) {
  const RoomWall wall = site.room().wall(side);
  RandomStream draws = site.draws(board_item + side);
  for (int i = 0; i < 8; ++i) {
    const bool notice = draws.below(2);
    const double width = notice ? 1.2 : 1.5;
    if (wall.length_m < width + 0.2) return;
    const double x = draws.uniform(0.1, wall.length_m - width - 0.1);
    if (!site.try_place(notice ? "notice_board" : "whiteboard", wall.frame, {x, 0, 0})) continue;
    if (notice) pin_papers(site, wall.frame, {x + 0.03, 1.18}, {x + 1.17, 1.97}, draws);
    return;
  }
}

void fit_sockets(BuildingSite& site, int side) {
  const RoomWall wall = site.room().wall(side);
  RandomStream draws = site.draws(socket_item + side);
  const int sockets = 1 + static_cast<int>(wall.length_m / 3);
  for (int i = 0; i < sockets; ++i) {
    const double x = (i + draws.uniform(0.1, 0.8)) * wall.length_m / sockets;
    site.try_place("socket", wall.frame, {x, 0, 0});
  }
}

}  // namespace

void furnish_room(BuildingSite& site, int window_side, double door_x_m) {
  const Style& style = styles[site.draws(style_item).below(styles.size())];
  const int door_side = (window_side + 2) % 4;
  hang_door(site, site.room().wall(door_side), door_x_m);
  open_windows(site, site.room().wall(window_side));
  fit_ceiling(site);
  furnish_wall(site, 1, style);
  furnish_wall(site, 3, style);
  furnish_wall(site, window_side, style);
  furnish_wall(site, door_side, style);
  for (int side = 0; side < 4; ++side) {
    const RoomWall wall = site.room().wall(side);
    mount_boards(site, side);
    fit_sockets(site, side);
    RandomStream cables = site.draws(cable_item + side);
    run_cables(site, wall, cables);
    RandomStream pictures = site.draws(picture_item + side);
    hang_pictures(site, wall, static_cast<int>(wall.length_m), pictures);
    RandomStream cartons = site.draws(carton_item + side);
    drop_cartons(site, wall, 2, cartons);
  }
}

}  // namespace vernier::sim::internal
