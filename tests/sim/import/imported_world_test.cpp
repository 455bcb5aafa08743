// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/import/imported_world.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "calib/statistics/random.h"
#include "sim/import/axes_and_unit.h"
#include "sim/import/convex_faces.h"
#include "sim/import/even_storeys.h"
#include "sim/import/mesh.h"
#include "sim/import/storeys.h"
#include "sim/routing/floor_plan.h"
#include "sim/routing/route_proposal.h"
#include "sim/study/free_floor.h"
#include "sim/study/upright_edges.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/sim/import/made_meshes.h"
#include "tests/support/error_message.h"

namespace vernier::sim::internal {
namespace {

using test::add_box;
using test::add_rectangle;
using vernier::test::error_message;

/// Two storeys of the house and their slabs.
Mesh two_storeys() {
  Mesh mesh = test::house();
  const Mesh upper = test::house(3, false);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), upper.vertices.begin(), upper.vertices.end());
  for (const auto& [a, b, c] : upper.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
  add_box(mesh, {-0.1, -0.1, 2.7}, {8.2, 3.1, 3});
  return mesh;
}

Mesh turned_and_scaled(Mesh mesh, int up, double unit_m) {
  for (Eigen::Vector3d& v : mesh.vertices) {
    if (up == 1) v = Eigen::Vector3d(v.x(), v.z(), -v.y());
    if (up == 0) v = Eigen::Vector3d(v.z(), v.y(), -v.x());
    v /= unit_m;
  }
  return mesh;
}

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

// The outer faces of a house go down to its footing; its rooms do not.
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

// However finely the walls are cut.
TEST(Storeys, AreFoundInFineMeshes) {
  Mesh mesh;
  for (const double z : {0.0, 3.0}) {
    add_rectangle(mesh, {0, 0, z}, {12, 0, 0}, {0, 8, 0}, 24, 16);
    add_rectangle(mesh, {0, 0, z}, {12, 0, 0}, {0, 0, 2.7}, 24, 6);
    add_rectangle(mesh, {12, 8, z}, {-12, 0, 0}, {0, 0, 2.7}, 24, 6);
    add_rectangle(mesh, {0, 8, z}, {0, -8, 0}, {0, 0, 2.7}, 16, 6);
    add_rectangle(mesh, {12, 0, z}, {0, 8, 0}, {0, 0, 2.7}, 16, 6);
  }
  const ImportedWorld imported = import_world(mesh, {}, "m.obj");
  EXPECT_EQ(imported.report.axes.up_axis, 2);
  EXPECT_EQ(imported.report.storeys_m.size(), 2u);
  EXPECT_EQ(imported.world.loose.segments_m.size(), 12u);
}

TEST(ImportedWorld, RefusesWhatItsReaderRounded) {
  Mesh mesh = test::house();
  mesh.step = 0.25;
  EXPECT_NE(error_message([&] { import_world(mesh, {}, "m.obj"); }).find("rounds to 0.25 m"),
            std::string::npos);
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

// Property: unit, axis, and where a building stands change nothing but the plan's origin.
TEST(ImportedWorld, IsTheSameInAnyUnitAndAxis) {
  const ImportedWorld plain = import_world(test::house(), {}, "m.obj");
  EXPECT_EQ(plain.report.outside, 0u);
  EXPECT_GE(plain.world.loose.segments_m.size(), 45u);
  for (const int up : {0, 1, 2}) {
    for (const double unit : {1.0, 0.001}) {
      const ImportedWorld other =
          import_world(turned_and_scaled(test::house(), up, unit), {}, "m.obj");
      ASSERT_EQ(other.world.loose.segments_m.size(), plain.world.loose.segments_m.size());
      EXPECT_EQ(other.world.loose.surfaces_m.size(), plain.world.loose.surfaces_m.size());
    }
  }
  Mesh far = test::house();
  for (Eigen::Vector3d& v : far.vertices) v += Eigen::Vector3d(512'000, -4'000'000, 120);
  const ImportedWorld moved = import_world(far, {}, "m.obj");
  EXPECT_EQ(moved.world.loose.segments_m.size(), plain.world.loose.segments_m.size());
  EXPECT_NEAR(moved.report.moved_m.x(), 512'000, 1);
  EXPECT_NEAR(moved.report.floor_m, 120, 1e-6);
}

Mesh leaning(Mesh mesh, double degrees, const Eigen::Vector3d& about) {
  const Eigen::AngleAxisd lean(degrees * std::numbers::pi / 180, about.normalized());
  for (Eigen::Vector3d& v : mesh.vertices) v = lean * v;
  return mesh;
}

int count_upright(const WorldDescription& world) {
  return static_cast<int>(
      std::count_if(world.loose.segments_m.begin(), world.loose.segments_m.end(),
                    [](const auto& segment) { return is_upright(segment.first, segment.second); }));
}

// Property: a building out of level is the one in level, and says so.
TEST(ImportedWorld, IsLevelledIfFloorAndWallsLean) {
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const ImportedWorld plain = import_world(test::house(), options, "m.obj");
  EXPECT_EQ(plain.report.levelled_deg, 0);
  EXPECT_EQ(plain.report.made_upright, 0u);
  for (const double degrees : {0.005, 0.05, 0.4, 2.5}) {
    for (const Eigen::Vector3d& about :
         {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1, -2, 0)}) {
      const ImportedWorld other =
          import_world(leaning(test::house(), degrees, about), options, "m.obj");
      EXPECT_NEAR(other.report.levelled_deg, degrees < 0.02 ? 0 : degrees, 1e-3);
      EXPECT_EQ(other.world.loose.segments_m.size(), plain.world.loose.segments_m.size());
      EXPECT_EQ(count_upright(other.world), count_upright(plain.world)) << degrees;
    }
  }
}

// A floor that rises between upright walls stays as it is.
TEST(ImportedWorld, IsNotLevelledByARamp) {
  Mesh mesh = test::house(0, false);
  add_rectangle(mesh, {0, 0, 0}, {8.1, 0, 0.3}, {0, 3, 0});
  add_rectangle(mesh, {0, 0, 2.1}, {8.1, 0, 0.3}, {0, 3, 0});
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  EXPECT_EQ(import_world(mesh, options, "m.obj").report.levelled_deg, 0);
}

// Property: a building that was turned and written in whole millimetres has the edges of the one
// before, though rounding turns its short pieces by degrees; round things stay round.
TEST(ImportedWorld, IsTheSameInWholeMillimetres) {
  Mesh mesh = test::house();
  for (int i = 0; i < 40; ++i) {  // pieces of walls, whose corners cut its edges into short pieces
    add_rectangle(mesh, {0.2 * i, 0, 0}, {0.2, 0, 0}, {0, 0, 0.03 + 0.01 * (i % 3)});
  }
  mesh = turned_and_scaled(leaning(mesh, 33, {0, 0, 1}), 2, 1);
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const ImportedWorld exact = import_world(mesh, options, "m.obj");
  for (Eigen::Vector3d& v : mesh.vertices) v = (v * 1000).array().round() / 1000;
  const ImportedWorld rounded = import_world(mesh, options, "m.obj");
  EXPECT_EQ(rounded.report.edges, exact.report.edges);
  EXPECT_EQ(rounded.world.loose.segments_m.size(), exact.world.loose.segments_m.size());
  // A bow of 1 m radius in pieces of 0.2 m.
  Mesh bow = test::house();
  for (int i = 0; i < 15; ++i) {
    const auto at = [](int k) { return Eigen::Vector3d(std::sin(0.2 * k), std::cos(0.2 * k), 1); };
    bow.lines.push_back({static_cast<std::uint32_t>(bow.vertices.size()),
                         static_cast<std::uint32_t>(bow.vertices.size() + 1)});
    for (const int k : {i, i + 1}) bow.vertices.push_back((at(k) * 1000).array().round() / 1000);
  }
  EXPECT_EQ(import_world(bow, options, "m.obj").report.edges,
            import_world(test::house(), options, "m.obj").report.edges + 15);
}

// Vertices that jitter by a third of a millimetre leave no edge exactly upright.
TEST(ImportedWorld, NearlyUprightEdgesBecomeUpright) {
  Mesh mesh = test::house();
  vernier::internal::RandomStream draws({.seed = 4});
  std::map<std::array<double, 3>, Eigen::Vector3d> moved;
  for (Eigen::Vector3d& v : mesh.vertices) {
    const auto [at, is_new] = moved.try_emplace({v.x(), v.y(), v.z()});
    if (is_new) at->second = v + 1e-4 * Eigen::Vector3d(draws.normal(), draws.normal(), 0);
    v = at->second;
  }
  ImportOptions options;
  const ImportedWorld snapped = import_world(mesh, options, "m.obj");
  options.upright_deg = 0;
  const ImportedWorld kept = import_world(mesh, options, "m.obj");
  EXPECT_EQ(kept.report.made_upright, 0u);
  EXPECT_GT(snapped.report.made_upright, 20u);
  EXPECT_GE(count_upright(snapped.world),
            count_upright(import_world(test::house(), {}, "m.obj").world) - 1);
  EXPECT_LT(count_upright(kept.world), 8);
  EXPECT_EQ(snapped.world.loose.segments_m.size(), kept.world.loose.segments_m.size());
  for (std::size_t i = 0; i < kept.world.loose.segments_m.size(); ++i) {
    const Segment &was = kept.world.loose.segments_m[i], &is = snapped.world.loose.segments_m[i];
    EXPECT_LT((was.first - is.first).norm() + (was.second - is.second).norm(), 2e-3);
  }
}

TEST(ImportedWorld, IsOneStorey) {
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const ImportedWorld lower = import_world(two_storeys(), options, "m.obj");
  options.storey = 2;
  const ImportedWorld upper = import_world(two_storeys(), options, "m.obj");
  for (const ImportedWorld* world : {&lower, &upper}) {
    double low = 1e9, high = -1e9;
    for (const auto& [a, b] : world->world.loose.segments_m) {
      low = std::min({low, a.z(), b.z()});
      high = std::max({high, a.z(), b.z()});
    }
    EXPECT_NEAR(low, 0, 0.02);
    EXPECT_LT(high, 3);
  }
  EXPECT_NEAR(upper.report.floor_m, 3, 1e-9);
  options.storey = 3;
  EXPECT_EQ(error_message([&] { import_world(two_storeys(), options, "m.obj"); }),
            "m.obj: has 2 storeys, and no storey 3; give one of them, or the floor's height");
}

TEST(ImportedWorld, RefusesWhatIsNone) {
  EXPECT_EQ(error_message([] { import_world({}, {}, "m.obj"); }),
            "m.obj: holds no triangles and no lines; export the geometry of a building");
  Mesh bad = test::house();
  bad.vertices[5].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_message([&] { import_world(bad, {}, "m.obj"); }),
            "m.obj: vertex 5 is not finite; correct it, or export again");
}

// Property: the route leads through both rooms, where a robot can stand, and each leg begins where
// a robot gets to from the first.
TEST(ProposedRoute, LeadsThroughAllRooms) {
  WorldDescription description = import_world(test::house(), {}, "m.obj").world;
  const RouteProposal proposal = propose_route(FloorPlan(build_world(description), 1.2));
  ASSERT_FALSE(proposal.route.empty());
  EXPECT_GT(proposal.near_m2, 0.85 * proposal.floor_m2);
  EXPECT_NEAR(proposal.floor_m2, 8 * 2.7, 4);  // the robot keeps away from walls
  description.route = {proposal.route[0]};
  const World world = build_world(description);
  const Visibility visibility(world);
  const FreeFloor floor(visibility, 1.2);
  bool left = false, right = false;
  const double length = route_length_m(proposal.route);
  for (double s = 0; s < length; s += 0.1) {
    const auto pose = route_point(proposal.route, s).pose;
    EXPECT_TRUE(floor.reaches({pose.x_m, pose.y_m})) << pose.x_m << ' ' << pose.y_m;
    EXPECT_TRUE(pose.x_m > 0 && pose.x_m < 8.2) << "it leaves the house by its open door";
    left = left || pose.x_m < 2;
    right = right || pose.x_m > 6;
  }
  EXPECT_TRUE(left && right);
}

// A stairwell in a floor, and a roof too low to stand below, are no ways.
TEST(ProposedRoute, KeepsOutOfHolesAndFromBelowRoofs) {
  Mesh mesh;
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    add_box(mesh, {x0, y0, 0}, {x1, y1, 2.6});
  };
  wall(-0.1, -0.1, 12.1, 0);
  wall(-0.1, 8, 12.1, 8.1);
  wall(-0.1, 0, 0, 8);
  wall(12, 0, 12.1, 8);
  add_rectangle(mesh, {0, 0, 0}, {12, 0, 0}, {0, 3, 0});
  add_rectangle(mesh, {0, 5, 0}, {12, 0, 0}, {0, 3, 0});
  add_rectangle(mesh, {0, 3, 0}, {4, 0, 0}, {0, 2, 0});
  add_rectangle(mesh, {7, 3, 0}, {5, 0, 0}, {0, 2, 0});
  add_rectangle(mesh, {9, 0, 0.8}, {3, 0, 0.4}, {0, 8, 0});  // a slope under which no robot fits
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  const World world = build_world(import_world(mesh, options, "m.obj").world);
  const RouteProposal proposal = propose_route(FloorPlan(world, 1.2));
  ASSERT_GT(route_length_m(proposal.route), 8);
  for (double s = 0; s < route_length_m(proposal.route); s += 0.1) {
    const auto pose = route_point(proposal.route, s).pose;
    EXPECT_FALSE(pose.x_m > 4.4 && pose.x_m < 6.6 && pose.y_m > 3.4 && pose.y_m < 4.6);
    EXPECT_LT(pose.x_m, 9.1);
  }
  EXPECT_TRUE(propose_route(FloorPlan(world, 1.2)).route.size() > 0);
}

/// A plot of 30 x 20 m with two houses that are solid blocks; `has_ground_below` if the ground goes
/// on below them. A fence 1.8 m high with a gate of this width; none for a width below 0.
World plot(bool has_ground_below, double gate_m) {
  Mesh mesh;
  if (has_ground_below) {
    add_box(mesh, {0, 0, -0.2}, {30, 20, 0});
  } else {
    add_rectangle(mesh, {0, 0, 0}, {30, 0, 0}, {0, 4, 0});
    add_rectangle(mesh, {0, 4, 0}, {4, 0, 0}, {0, 9, 0});
    add_rectangle(mesh, {13, 4, 0}, {4, 0, 0}, {0, 9, 0});
    add_rectangle(mesh, {26, 4, 0}, {4, 0, 0}, {0, 9, 0});
    add_rectangle(mesh, {0, 13, 0}, {30, 0, 0}, {0, 7, 0});
  }
  add_box(mesh, {4, 4, 0}, {13, 13, 5});
  add_box(mesh, {17, 4, 0}, {26, 13, 6});
  if (gate_m >= 0) {
    add_box(mesh, {0, 0, 0}, {12, 0.1, 1.8});
    add_box(mesh, {12 + gate_m, 0, 0}, {30, 0.1, 1.8});
    add_box(mesh, {0, 19.9, 0}, {30, 20, 1.8});
    add_box(mesh, {0, 0.1, 0}, {0.1, 19.9, 1.8});
    add_box(mesh, {29.9, 0.1, 0}, {30, 19.9, 1.8});
  }
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  return build_world(import_world(mesh, options, "m.obj").world);
}

// Property: on a plot the route is in the yard, never inside of a solid house, and its openness is
// told.
TEST(ProposedRoute, KeepsOutOfSolidBodies) {
  for (const bool has_ground_below : {false, true}) {
    for (const double gate_m : {-1.0, 0.0, 1.5, 3.2}) {
      const World world = plot(has_ground_below, gate_m);
      const RouteProposal proposal = propose_route(FloorPlan(world, 1.2));
      ASSERT_GT(route_length_m(proposal.route), 60) << has_ground_below << ' ' << gate_m;
      for (double s = 0; s < route_length_m(proposal.route); s += 0.2) {
        const auto pose = route_point(proposal.route, s).pose;
        EXPECT_FALSE(pose.y_m > 4 && pose.y_m < 13 && pose.x_m > 4 && pose.x_m < 26 &&
                     !(pose.x_m > 13 && pose.x_m < 17));
      }
      EXPECT_NEAR(proposal.floor_m2, 600 - 162, 60);
      EXPECT_EQ(proposal.other_m2, 0);
      EXPECT_EQ(proposal.is_open, gate_m < 0 || gate_m > 2);
      EXPECT_NEAR(proposal.gap_m, gate_m > 2 ? gate_m : 0, 0.3);
    }
  }
}

// A room whose only surfaces face outwards is a room if there is nothing else.
TEST(ProposedRoute, IsInARoomWithoutThickness) {
  Mesh mesh;
  add_box(mesh, {0, 0, 0}, {8, 6, 2.6});
  const RouteProposal proposal =
      propose_route(FloorPlan(build_world(import_world(mesh, {}, "m.obj").world), 1.2));
  EXPECT_GT(route_length_m(proposal.route), 3);
  EXPECT_NEAR(proposal.floor_m2, 48 - 4, 3);
  EXPECT_FALSE(proposal.is_open);
}

TEST(ProposedRoute, SaysWhatIsCutOff) {
  Mesh mesh = test::house();
  add_box(mesh, {4.02, 1, 0}, {4.06, 2, 2.1});  // its inner door, closed
  const RouteProposal proposal =
      propose_route(FloorPlan(build_world(import_world(mesh, {}, "m.obj").world), 1.2));
  EXPECT_NEAR(proposal.floor_m2, 4 * 2.7, 1.5);
  EXPECT_NEAR(proposal.other_m2, 4 * 2.7, 1.5);
  EXPECT_EQ(
      propose_route(FloorPlan(build_world(import_world(test::house(), {}, "m.obj").world), 1.2))
          .other_m2,
      0);
}

TEST(ProposedRoute, IsEmptyWithoutFloor) {
  Mesh mesh;
  add_box(mesh, {0, 0, 0}, {0.3, 0.3, 2.5});
  add_rectangle(mesh, {0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0});
  ImportOptions options;
  options.unit_m = 1;
  options.up_axis = 2;
  const RouteProposal proposal =
      propose_route(FloorPlan(build_world(import_world(mesh, options, "m.obj").world), 1.2));
  EXPECT_LT(proposal.near_m2, 40);  // around the box at most
}

}  // namespace
}  // namespace vernier::sim::internal
