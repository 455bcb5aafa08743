// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/storeys.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/import/axes_and_unit.h"
#include "sim/import/convex_faces.h"
#include "sim/import/even_storeys.h"
#include "sim/import/levels.h"
#include "sim/import/mesh.h"
#include "tests/sim/import/made_meshes.h"
#include "tests/support/error_message.h"

namespace vernier::sim::internal {
namespace {

using test::add_box;
using test::add_rectangle;
using test::turned_and_scaled;
using test::two_storeys;
using vernier::test::error_message;

TEST(Storeys, AreWhereWallsBegin) {
  const std::vector<double> floors = floor_heights_m(convex_faces(welded(two_storeys(), 5e-4)));
  ASSERT_EQ(floors.size(), 2u);
  EXPECT_NEAR(floors[0], 0, 1e-9);
  EXPECT_NEAR(floors[1], 3, 1e-9);
  // Furniture is no storey, and a building without a floor has one.
  Mesh furnished = test::house(0, false);
  for (int i = 0; i < 3; ++i) add_box(furnished, {1.0 + i, 1, 0.7}, {1.8 + i, 2, 0.75});
  EXPECT_EQ(floor_heights_m(convex_faces(welded(furnished, 5e-4))).size(), 1u);
}

// A gable stands on walls, not on a floor.
TEST(Storeys, AreNotGables) {
  Mesh mesh = test::house();
  const auto add = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                       const Eigen::Vector3d& c) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  for (const double x : {-0.1, 8.2}) add({x, -0.1, 2.5}, {x, 3.1, 2.5}, {x, 1.5, 4.5});
  add_rectangle(mesh, {-0.1, -0.1, 2.5}, {8.3, 0, 0}, {0, 1.6, 2});
  add_rectangle(mesh, {-0.1, 3.1, 2.5}, {8.3, 0, 0}, {0, -1.6, 2});
  for (double x = 0.5; x < 8; x += 0.5) add({x, -0.1, 2.5}, {x, 3.1, 2.5}, {x, 1.5, 4.5});
  EXPECT_EQ(floor_heights_m(convex_faces(welded(mesh, 5e-4))).size(), 1u);
  // With a floor below it, it is an attic.
  add_rectangle(mesh, {-0.1, -0.1, 2.5}, {8.3, 0, 0}, {0, 3.2, 0});
  EXPECT_EQ(floor_heights_m(convex_faces(welded(mesh, 5e-4))).size(), 2u);
}

/// Adds a storey on a slab of its own size: four walls 0.2 m thick.
void add_storey(Mesh& mesh, double x, double y, double length, double width, double z, double h) {
  add_box(mesh, {x, y, z - 0.25}, {x + length, y + width, z});
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    add_box(mesh, {x0, y0, z}, {x1, y1, z + h - 0.25});
  };
  wall(x, y, x + length, y + 0.2);
  wall(x, y + width - 0.2, x + length, y + width);
  wall(x, y, x + 0.2, y + width);
  wall(x + length - 0.2, y, x + length, y + width);
}

std::vector<double> floors_of(const Mesh& mesh) {
  return floor_heights_m(convex_faces(welded(mesh, 5e-4)));
}

void expect_floors(const Mesh& mesh, const std::vector<double>& expected) {
  const std::vector<double> floors = floors_of(mesh);
  ASSERT_EQ(floors.size(), expected.size());
  for (std::size_t i = 0; i < floors.size(); ++i) EXPECT_NEAR(floors[i], expected[i], 0.01);
}

// A floor is measured by the walls on it, not by the ground around the house.
TEST(Storeys, AreFoundOnALargePlotAndOnAPodium) {
  for (const double plot : {20.0, 34.0, 70.0, 300.0}) {
    Mesh mesh;
    add_rectangle(mesh, {-plot / 2, -plot / 2, 0}, {plot, 0, 0}, {0, plot, 0});
    for (const double z : {0.0, 3.0}) add_storey(mesh, 0, 0, 12, 9, z, 3);
    add_box(mesh, {0, 0, 5.75}, {12, 9, 6});
    expect_floors(mesh, {0, 3});
    // Its gable is none.
    for (double x = 0.5; x < 12; x += 0.5) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), {{x, 1, 6.5}, {x, 8, 6.5}, {x, 4.5, 9}});
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    expect_floors(mesh, {0, 3});
  }
  Mesh tower;
  add_storey(tower, 0, 0, 60, 40, 0, 4.5);
  add_box(tower, {0, 0, 4.25}, {60, 40, 4.5});
  for (int i = 0; i < 4; ++i) add_storey(tower, 10, 10, 15, 15, 4.5 + 3.3 * i, 3.3);
  add_box(tower, {10, 10, 17.45}, {25, 25, 17.7});
  expect_floors(tower, {0, 4.5, 7.8, 11.1, 14.4});
}

// A sheet that faces down is a floor too, if walls stand on it and carry another; it is none below
// a gable or a parapet.
TEST(Storeys, MayHaveFloorsThatFaceDown) {
  const auto with_walls = [](double upper_m) {
    Mesh mesh;
    add_rectangle(mesh, {0, 0, 0}, {10, 0, 0}, {0, 8, 0});
    // The upper walls are thinner: else they are one with the lower.
    for (const auto& [low, high, in] : {std::tuple(0.0, 3.0, 0.0), {3.0, upper_m, 0.05}}) {
      add_box(mesh, {in, in, low}, {10 - in, 0.2, high});
      add_box(mesh, {in, 7.8, low}, {10 - in, 8 - in, high});
      add_box(mesh, {in, in, low}, {0.2, 8 - in, high});
      add_box(mesh, {9.8, in, low}, {10 - in, 8 - in, high});
    }
    add_rectangle(mesh, {0, 0, 3}, {0, 8, 0}, {10, 0, 0});
    return mesh;
  };
  Mesh house = with_walls(6);
  add_rectangle(house, {0, 0, 6}, {0, 8, 0}, {10, 0, 0});
  expect_floors(house, {0, 3});
  expect_floors(with_walls(4.8), {0});  // a parapet
}

// Façades are often one face over all storeys, and walls that stand on each other without a slab
// are one: the floors between them are storeys, a gallery, a parapet and a low attic are none.
TEST(Storeys, MayHaveWallsThatPassByTheirFloors) {
  const auto shell = [](double top, bool is_sheet) {
    Mesh mesh;
    const double in = is_sheet ? 0 : 0.2;
    for (const double y : {0.0, 8 - in}) add_box(mesh, {0, y, 0}, {10, y + in, top});
    for (const double x : {0.0, 10 - in}) add_box(mesh, {x, in, 0}, {x + in, 8 - in, top});
    add_rectangle(mesh, {0, 0, 0}, {10, 0, 0}, {0, 8, 0});
    return mesh;
  };
  const auto with_floors = [](Mesh mesh, const std::vector<double>& heights, double slab_m) {
    for (const double z : heights) {
      if (slab_m > 0) {
        add_box(mesh, {0, 0, z - slab_m}, {10, 8, z});
      } else {
        add_rectangle(mesh, {0, 0, z}, {10, 0, 0}, {0, 8, 0});
      }
    }
    return mesh;
  };
  for (const bool is_sheet : {false, true}) {
    for (const double slab_m : {0.0, 0.3}) {
      expect_floors(with_floors(shell(9, is_sheet), {3, 6, 9}, slab_m), {0, 3, 6});
      expect_floors(with_floors(shell(4, is_sheet), {3}, slab_m), {0});     // a parapet
      expect_floors(with_floors(shell(3, is_sheet), {3}, slab_m), {0});     // a roof
      expect_floors(with_floors(shell(9, is_sheet), {2, 9}, slab_m), {0});  // too low to stand
    }
  }
  Mesh hall = with_floors(shell(7, false), {7}, 0.3);
  add_box(hall, {0, 0, 2.8}, {4, 8, 3});  // a gallery over two fifths of it
  expect_floors(hall, {0});
  // On a plot that is larger than the house, also than one with two wings and than two houses.
  for (const double edge : {20.0, 60.0}) {
    const auto on_plot = [&](Mesh mesh) {
      add_rectangle(mesh, {-edge, -edge, -0.005}, {40 + 2 * edge, 0, 0}, {0, 40 + 2 * edge, 0});
      return mesh;
    };
    expect_floors(on_plot(with_floors(shell(6, false), {3, 6}, 0.3)), {0, 3});
    Mesh wings, houses;
    const auto add_block = [](Mesh& mesh, double x, double y, double length, double width) {
      for (const double at : {y, y + width - 0.2}) {
        add_box(mesh, {x, at, 0}, {x + length, at + 0.2, 6});
      }
      for (const double at : {x, x + length - 0.2}) {
        add_box(mesh, {at, y + 0.2, 0}, {at + 0.2, y + width - 0.2, 6});
      }
      for (const double z : {0.0, 3.0, 6.0}) {
        add_box(mesh, {x, y, z - 0.3}, {x + length, y + width, z});
      }
    };
    add_block(wings, 0, 0, 30, 8);
    add_block(wings, 0, 8, 8, 22);
    expect_floors(on_plot(wings), {0, 3});
    add_block(houses, 0, 0, 10, 8);
    add_block(houses, 25, 0, 10, 8);
    expect_floors(on_plot(houses), {0, 3});
  }
}

// Walls below a floor are of a storey, also where the ground has no slab.
TEST(Storeys, MayLackASlabAtTheGround) {
  Mesh mesh = test::house(0, false);
  const Mesh upper = test::house(3);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), upper.vertices.begin(), upper.vertices.end());
  for (const auto& [a, b, c] : upper.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
  const std::vector<double> floors = floor_heights_m(convex_faces(welded(mesh, 5e-4)));
  ASSERT_EQ(floors.size(), 2u);
  EXPECT_NEAR(floors[0], 0, 1e-9);
  EXPECT_NEAR(floors[1], 3, 1e-9);
}

// The outer faces of a house go down to its footing; its rooms do not.
TEST(Storeys, BeginWhereMostWallsDoAndNotAtThePlinth) {
  Mesh mesh;
  add_box(mesh, {0, 0, -1}, {10, 8, 2.7});
  for (const double x : {0.3, 3.5, 6.7}) {
    for (const double y : {0.3, 4.2}) add_box(mesh, {x, y, 0}, {x + 3, y + 3.5, 2.6});
  }
  const std::vector<double> floors = floor_heights_m(convex_faces(welded(mesh, 5e-4)));
  ASSERT_EQ(floors.size(), 1u);
  EXPECT_NEAR(floors[0], 0, 0.05);
}

std::optional<int> ground_of(const Mesh& mesh) {
  const Mesh joined = welded(mesh, 1e-4);
  return axis_of_ground(joined, different_triangles(joined));
}

// Level ground around a building shows which axis is up, whatever its size, with a fence or not; a
// façade that is longer than a wing is none.
TEST(AxesAndUnit, AreShownByTheGround) {
  for (const int up : {0, 1, 2}) {
    for (const double edge : {2.0, 20.0, 150.0}) {
      for (const double slab_m : {0.0, 0.2}) {
        Mesh mesh = test::house();
        const double x = 8.2 + edge, y = 3 + edge;
        if (slab_m > 0) {
          add_box(mesh, {-edge, -edge, -0.05 - slab_m}, {x, y, -0.05});
        } else {
          add_rectangle(mesh, {-edge, -edge, -0.05}, {x + edge, 0, 0}, {0, y + edge, 0});
        }
        EXPECT_EQ(ground_of(turned_and_scaled(mesh, up, 1)), up) << edge << " " << slab_m;
        add_box(mesh, {-edge, -edge, 0}, {x, -edge + 0.1, 1.3});  // a fence
        add_box(mesh, {-edge, y - 0.1, 0}, {x, y, 1.3});
        EXPECT_EQ(ground_of(turned_and_scaled(mesh, up, 1)), up) << edge << " " << slab_m;
      }
    }
    EXPECT_FALSE(ground_of(turned_and_scaled(test::house(), up, 1)));
    EXPECT_FALSE(ground_of(turned_and_scaled(two_storeys(), up, 1)));
    Mesh wings;
    add_box(wings, {0, 0, 0}, {27, 8, 4});
    add_box(wings, {0, 8, 0}, {16, 15, 3});
    EXPECT_FALSE(ground_of(turned_and_scaled(wings, up, 1)));
  }
}

TEST(AxesAndUnit, AreRecognised) {
  for (const int up : {0, 1, 2}) {
    for (const double unit : {1.0, 0.001}) {
      const Mesh mesh = turned_and_scaled(test::house(), up, unit);
      const AxesAndUnit axes = axes_and_unit(mesh, {}, {}, "m.obj");
      EXPECT_EQ(axes.up_axis, up);
      EXPECT_EQ(axes.unit_m, unit);
      Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
      for (const Eigen::Vector3d& v : upright(mesh, axes).vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
      }
      EXPECT_NEAR(high.z() - low.z(), 2.5, 1e-9);
      EXPECT_NEAR(low.z(), 0, 1e-9);
    }
  }
}

/// Storeys of 16 x 11 m: a corridor between rows of rooms, slabs, and doors in the walls.
Mesh block_of_offices(int storeys, double storey_m) {
  Mesh mesh;
  add_box(mesh, {-0.2, -0.2, -0.2}, {16.2, 11.2, 0});
  for (int i = 0; i < storeys; ++i) {
    const double low = i * storey_m, high = low + storey_m - 0.25;
    const auto wall = [&](double x0, double y0, double x1, double y1) {
      add_box(mesh, {x0, y0, low}, {x1, y1, high});
    };
    wall(-0.2, -0.2, 16.2, 0);
    wall(-0.2, 11, 16.2, 11.2);
    wall(-0.2, 0, 0, 11);
    wall(16, 0, 16.2, 11);
    for (const double y : {4.6, 6.4}) {
      for (int k = 0; k < 4; ++k) wall(4.0 * k, y, 4.0 * k + 3, y + 0.1);
    }
    for (int k = 1; k < 4; ++k) {
      wall(4.0 * k - 0.1, 0, 4.0 * k, 4.6);
      wall(4.0 * k - 0.1, 6.5, 4.0 * k, 11);
    }
    add_box(mesh, {-0.2, -0.2, high}, {16.2, 11.2, high + 0.25});
  }
  return mesh;
}

// Property: a building of several storeys stands upright, and its unit is that of its storeys, not
// of its height.
TEST(AxesAndUnit, OfSeveralStoreysAreRecognised) {
  for (const auto& [storeys, storey_m] :
       {std::pair(2, 3.0), std::pair(3, 2.9), std::pair(4, 3.4), std::pair(7, 3.1)}) {
    for (const int up : {0, 1, 2}) {
      for (const double unit : {1.0, 0.01, 0.001, 0.3048}) {
        const Mesh mesh = turned_and_scaled(block_of_offices(storeys, storey_m), up, unit);
        if (storeys == 2 && (unit == 0.3048 || unit == 0.01)) {  // or one of 20 m, or in inches
          EXPECT_NE(
              error_message([&] { axes_and_unit(mesh, {}, {}, "m.obj"); }).find("which may be "),
              std::string::npos);
          continue;
        }
        const AxesAndUnit axes = axes_and_unit(mesh, {}, {}, "m.obj");
        EXPECT_EQ(axes.up_axis, up) << storeys;
        EXPECT_EQ(axes.unit_m, unit) << storeys;
      }
    }
  }
}

// A hall of 10 m is one of 3 m if its unit is a foot, and so of inches and centimetres.
TEST(AxesAndUnit, OfAHighHallAreAskedFor) {
  Mesh hall;
  add_box(hall, {0, 0, 0}, {60, 30, 10});
  const auto said = [&](double unit_m) {
    return error_message(
        [&] { axes_and_unit(turned_and_scaled(hall, 2, unit_m), 2, {}, "m.obj"); });
  };
  EXPECT_EQ(said(1),
            "m.obj: does not say its unit of length, which may be m (60 m long, 10 m high) or ft "
            "(18.3 m long, 3.05 m high); say which with --unit");
  EXPECT_NE(said(0.0254).find("may be cm (23.6 m long, 3.94 m high) or in ("), std::string::npos);
  EXPECT_NE(said(0.3048).find("may be m ("), std::string::npos);
  EXPECT_EQ(axes_and_unit(turned_and_scaled(hall, 2, 0.001), 2, {}, "m.obj").unit_m, 0.001);
  EXPECT_EQ(axes_and_unit(turned_and_scaled(hall, 2, 0.01), 2, {}, "m.obj").unit_m, 0.01);
}

TEST(EvenStoreys, AreCountedAndMeasured) {
  const Mesh mesh = block_of_offices(4, 3.4);
  const auto storeys = even_storeys(mesh, 2);
  ASSERT_TRUE(storeys);
  EXPECT_EQ(storeys->count, 4);
  EXPECT_NEAR(storeys->height, 3.4, 0.02);
  EXPECT_FALSE(even_storeys(block_of_offices(1, 3), 2));
  // Rooms in a row are no tower on its side.
  EXPECT_FALSE(even_storeys(block_of_offices(1, 3), 0));
}

// A corridor that is narrower than it is high looks like a low one that lies on its side.
TEST(AxesAndUnit, OfACorridorAreAskedFor) {
  for (const auto& [width, height] :
       {std::pair(1.5, 2.6), std::pair(2.2, 2.6), std::pair(2.6, 2.4), std::pair(4.0, 6.0)}) {
    Mesh corridor;
    add_box(corridor, {0, 0, 0}, {40, width, height});
    for (int door = 0; door < 20; ++door) {
      add_box(corridor, {1 + 1.9 * door, 0, 0}, {1.9 + 1.9 * door, 0.05, 2.1});
    }
    for (const int up : {0, 1, 2}) {
      const Mesh mesh = turned_and_scaled(corridor, up, 1);
      EXPECT_NE(error_message([&] {
                  axes_and_unit(mesh, {}, {}, "m.obj");
                }).find("does not say which axis is up"),
                std::string::npos)
          << width << " x " << height << ", up " << up;
      EXPECT_EQ(axes_and_unit(mesh, up, 1, "m.obj").up_axis, up);
    }
  }
}

TEST(AxesAndUnit, AreAskedForWhereTheyAreNotClear) {
  Mesh cube;
  add_box(cube, {0, 0, 0}, {5, 5, 5});
  EXPECT_EQ(error_message([&] { axes_and_unit(cube, {}, {}, "m.obj"); }),
            "m.obj: does not say which axis is up, and its shape does not show it; say so with "
            "--up x, y or z");
  Mesh hall;
  add_box(hall, {0, 0, 0}, {60, 40, 8});
  EXPECT_NE(error_message([&] { axes_and_unit(hall, {}, {}, "m.obj"); }).find("which may be m ("),
            std::string::npos);
  Mesh dust;
  add_box(dust, {0, 0, 0}, {1e-5, 1e-5, 2e-6});
  EXPECT_NE(error_message([&] { axes_and_unit(dust, {}, {}, "m.obj"); }).find("it is no building"),
            std::string::npos);
  // What is given is not questioned.
  EXPECT_EQ(axes_and_unit(cube, 1, 0.0254, "m.obj").unit_m, 0.0254);
}

}  // namespace
}  // namespace vernier::sim::internal
