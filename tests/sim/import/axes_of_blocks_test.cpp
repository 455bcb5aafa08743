// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/statistics/random.h"
#include "sim/import/axes_and_unit.h"
#include "sim/import/mesh.h"
#include "tests/sim/import/made_meshes.h"
#include "tests/support/error_message.h"

namespace vernier::sim::internal {
namespace {

using test::add_box;
using test::add_rectangle;
using test::turned_and_scaled;
using vernier::test::error_message;

/// A block of rooms between walls that go through, with a door in each, in metres.
struct Block {
  double length_m = 20, width_m = 10;
  int storeys = 1;
  double storey_m = 3, ground_m = 3;  // the lowest storey has its own height
  std::vector<double> across, along;  // where inner walls stand, as shares of length and width
  double roof_m = 0;                  // a pitched one, above the last slab
  double slab_m = 0.25;               // or 0: each a single sheet
  double wall_m = 0.2;                // or 0
  bool facades_pass_floors = false;   // and are not one to a storey
  double wing_m = 0;                  // of an L, beside the length, as wide as the block
};

/// Where a wall stands and how high.
struct BlockWall {
  bool is_along_x = true;  // or y
  double at = 0, from = 0, to = 0, low = 0, high = 0;
  bool has_door = false;  // of 0.9 x 2.1 m
};

void add_wall(Mesh& mesh, const BlockWall& wall, double thickness_m) {
  constexpr double door_m = 0.8, door_width_m = 0.9, door_height_m = 2.1;
  const auto piece = [&](double from, double to, double low, double high) {
    const auto placed = [&](double along, double across, double z) {
      return wall.is_along_x ? Eigen::Vector3d(along, across, z)
                             : Eigen::Vector3d(across, along, z);
    };
    const double half_m = thickness_m / 2;
    if (half_m > 0) {
      return add_box(mesh, placed(from, wall.at - half_m, low), placed(to, wall.at + half_m, high));
    }
    add_rectangle(mesh, placed(from, wall.at, low), placed(to - from, 0, 0), {0, 0, high - low});
  };
  if (!wall.has_door) return piece(wall.from, wall.to, wall.low, wall.high);
  const double door = wall.from + door_m;
  piece(wall.from, door, wall.low, wall.high);
  piece(door, door + door_width_m, wall.low + door_height_m, wall.high);
  piece(door + door_width_m, wall.to, wall.low, wall.high);
}

/// Part of a plan: the block, or the wing of its L.
struct Part {
  double x, from_y, to_y;
};

std::vector<Part> parts_of(const Block& block) {
  std::vector<Part> parts{{block.length_m, 0, block.width_m}};
  if (block.wing_m > 0) {
    parts.push_back({block.width_m, block.width_m, block.width_m + block.wing_m});
  }
  return parts;
}

void add_slabs(Mesh& mesh, const Block& block, double z) {
  const double over = block.wall_m / 2;
  for (const auto& [x, from_y, to_y] : parts_of(block)) {
    if (block.slab_m > 0) {
      add_box(mesh, {-over, from_y - over, z - block.slab_m}, {x + over, to_y + over, z});
    } else {
      add_rectangle(mesh, {0, from_y, z}, {x, 0, 0}, {0, to_y - from_y, 0});
    }
  }
}

void add_facades(Mesh& mesh, const Block& block, double low, double high) {
  for (const auto& [x, from_y, to_y] : parts_of(block)) {
    add_wall(mesh, {true, from_y, 0, x, low, high, low == 0}, block.wall_m);
    add_wall(mesh, {true, to_y, 0, x, low, high, false}, block.wall_m);
    add_wall(mesh, {false, 0, from_y, to_y, low, high, false}, block.wall_m);
    add_wall(mesh, {false, x, from_y, to_y, low, high, false}, block.wall_m);
  }
}

void add_inner_walls(Mesh& mesh, const Block& block, double low, double high) {
  for (const auto& [x, from_y, to_y] : parts_of(block)) {
    const double y = to_y - from_y;
    for (const double at : block.across) {
      add_wall(mesh, {false, at * x, from_y, to_y, low, high, true}, block.wall_m);
    }
    for (const double at : block.along) {
      add_wall(mesh, {true, from_y + at * y, 0, x, low, high, true}, block.wall_m);
    }
  }
}

Mesh mesh_of(const Block& block) {
  Mesh mesh;
  const double x = block.length_m, y = block.width_m;
  double z = 0;
  for (int storey = 0; storey < block.storeys; ++storey) {
    const double height = storey == 0 ? block.ground_m : block.storey_m;
    const double top = z + height - block.slab_m;
    add_slabs(mesh, block, z);
    if (!block.facades_pass_floors) add_facades(mesh, block, z, top);
    add_inner_walls(mesh, block, z, top);
    z += height;
  }
  if (block.facades_pass_floors) add_facades(mesh, block, 0, z - block.slab_m);
  add_slabs(mesh, block, z);
  if (block.roof_m > 0) {
    add_rectangle(mesh, {0, -0.4, z}, {x, 0, 0}, {0, y / 2 + 0.4, block.roof_m});
    add_rectangle(mesh, {0, y + 0.4, z}, {x, 0, 0}, {0, -y / 2 - 0.4, block.roof_m});
  }
  return mesh;
}

/// Places of inner walls: even, or up to a fifth of a room from that.
std::vector<double> inner_walls(int rooms, bool is_even, vernier::internal::RandomStream& draws) {
  std::vector<double> at;
  for (int i = 1; i < rooms; ++i) {
    at.push_back((i + (is_even ? 0.0 : draws.uniform(-0.2, 0.2))) / rooms);
  }
  return at;
}

Block drawn_block(std::uint32_t number) {
  vernier::internal::RandomStream draws({.seed = 381127, .trial = number});
  const auto whole = [&](int low, int high) {
    return low + static_cast<int>(draws.uniform() * (high - low + 1));
  };
  Block block;
  block.length_m = draws.uniform(12, 40);
  block.width_m = draws.uniform(6, 12);
  block.storeys = whole(0, 1) == 0 ? whole(1, 2) : whole(2, 5);
  block.storey_m = draws.uniform(2.6, 3.6);
  block.ground_m = block.storey_m + (whole(0, 2) == 0 ? draws.uniform(0.3, 2) : 0);
  const bool is_even = whole(0, 1) == 0;
  block.across = inner_walls(whole(1, 6), is_even, draws);
  block.along = inner_walls(whole(1, 3), is_even, draws);
  block.roof_m = whole(0, 2) == 0 ? draws.uniform(1.5, 3) : 0;
  block.slab_m = whole(0, 2) == 0 ? 0 : 0.25;
  block.wall_m = whole(0, 2) == 0 ? 0 : 0.2;
  block.facades_pass_floors = whole(0, 2) == 0;
  block.wing_m = whole(0, 2) == 0 ? draws.uniform(4, 12) : 0;
  return block;
}

/// The axis that is taken for up; nothing where it is asked for.
std::optional<int> up_of(const Mesh& mesh) {
  std::optional<int> up;
  const std::string said = error_message([&] { up = axes_and_unit(mesh, {}, 1, "m.obj").up_axis; });
  if (!said.empty()) {
    EXPECT_NE(said.find("say so with --up"), std::string::npos) << said;
  }
  return up;
}

// Property: a building is never laid on its side without a word, and often not asked for. Nothing
// was tuned on these draws.
TEST(AxesAndUnit, OfBlocksAreRightOrAskedFor) {
  constexpr int blocks = 240;
  int one = 0, several = 0, one_right = 0, several_right = 0;
  for (int i = 0; i < blocks; ++i) {
    const Block block = drawn_block(static_cast<std::uint32_t>(i));
    const std::optional<int> up = up_of(turned_and_scaled(mesh_of(block), i % 3, 1));
    EXPECT_EQ(up.value_or(i % 3), i % 3) << "block " << i;
    (block.storeys > 1 ? several : one) += 1;
    if (up) (block.storeys > 1 ? several_right : one_right) += 1;
  }
  EXPECT_GT(one_right, 0.6 * one);
  EXPECT_GT(several_right, 0.4 * several);
  RecordProperty("one_storey_right", std::to_string(one_right) + " of " + std::to_string(one));
  RecordProperty("several_right", std::to_string(several_right) + " of " + std::to_string(several));
}

// Rows of rooms of even width lay on their side, as storeys of a tower.
TEST(AxesAndUnit, OfRowsOfRoomsAreNotThoseOfATower) {
  Block bungalow{40, 12, 1, 3, 3, {0.5}, {1 / 3.0, 2 / 3.0}, 2, 0.25};
  Block shop{20, 9, 2, 2.8, 4.8, {0.5}, {0.5}, 3, 0.25};
  Block office{24, 12, 2, 3, 5, {0.25, 0.5, 0.75}, {1 / 3.0, 2 / 3.0}, 0, 0};
  for (const Block& block : {bungalow, shop, office}) {
    for (const int up : {0, 1, 2}) {
      EXPECT_EQ(up_of(turned_and_scaled(mesh_of(block), up, 1)).value_or(up), up) << block.length_m;
    }
  }
}

// On its side a tower one room deep would be a wide and low building.
TEST(AxesAndUnit, OfSlenderTowersAreRightOrAskedFor) {
  int right = 0, all = 0;
  for (const int storeys : {7, 8, 9}) {
    for (const double width_m : {5.3, 6.5}) {
      for (const double slab_m : {0.0, 0.25}) {
        for (const double wall_m : {0.0, 0.1, 0.35}) {
          Block block{31, width_m, storeys, 3.6, 4.3, {0.2, 0.45, 0.8}, {}, 0, slab_m, wall_m};
          if (all % 2 == 1) block.along = {0.55};
          const int up = all % 3;
          const std::optional<int> found = up_of(turned_and_scaled(mesh_of(block), up, 1));
          EXPECT_EQ(found.value_or(up), up) << storeys << " " << width_m << " " << slab_m;
          right += found.has_value();
          ++all;
        }
      }
    }
  }
  RecordProperty("right", std::to_string(right) + " of " + std::to_string(all));
}

// Two storeys, the lower one higher, have no even row of floors.
TEST(AxesAndUnit, OfTwoUnequalStoreysAreRecognised) {
  for (const double ground_m : {3.6, 4.2, 4.8}) {
    const Block block{24, 12, 2, 3, ground_m, {0.3, 0.55, 0.8}, {0.45}, 0, 0.25};
    for (const int up : {0, 1, 2}) {
      EXPECT_EQ(up_of(turned_and_scaled(mesh_of(block), up, 1)), up) << ground_m;
    }
  }
}

// Inner walls at even distances do not hide several storeys.
TEST(AxesAndUnit, OfSeveralStoreysOfEvenRoomsAreRecognised) {
  for (const int storeys : {2, 3, 4, 6}) {
    const Block block{24, 12, storeys, 3.2, 3.2, {0.25, 0.5, 0.75}, {1 / 3.0, 2 / 3.0}, 0, 0.25};
    for (const int up : {0, 1, 2}) {
      EXPECT_EQ(up_of(turned_and_scaled(mesh_of(block), up, 1)), up) << storeys;
    }
  }
}

}  // namespace
}  // namespace vernier::sim::internal
