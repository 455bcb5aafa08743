// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/routing/route_proposal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/import/imported_world.h"
#include "sim/import/mesh.h"
#include "sim/routing/floor_plan.h"
#include "sim/study/free_floor.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/sim/import/made_meshes.h"

namespace vernier::sim::internal {
namespace {

using test::add_box;
using test::add_rectangle;

World imported(const Mesh& mesh) {
  ImportOptions options;
  options.up_axis = 2;
  options.unit_m = 1;
  return build_world(import_world(mesh, options, "m.obj").world);
}

/// Whether a place on the route is within a rectangle.
bool enters(const RouteProposal& proposal, double x0, double y0, double x1, double y1) {
  for (double s = 0; s < route_length_m(proposal.route); s += 0.1) {
    const auto pose = route_point(proposal.route, s).pose;
    if (pose.x_m > x0 && pose.x_m < x1 && pose.y_m > y0 && pose.y_m < y1) return true;
  }
  return false;
}

/// Walls along the border of a rectangle that begins at the origin, with a gate in the front from
/// `gate_at_m` on.
void add_walls_around(Mesh& mesh,
                      const Eigen::Vector2d& size_m,
                      double thick_m,
                      double high_m,
                      double gate_at_m,
                      double gate_m) {
  const double x = size_m.x(), y = size_m.y();
  add_box(mesh, {0, 0, 0}, {gate_at_m, thick_m, high_m});
  add_box(mesh, {gate_at_m + gate_m, 0, 0}, {x, thick_m, high_m});
  add_box(mesh, {0, y - thick_m, 0}, {x, y, high_m});
  add_box(mesh, {0, thick_m, 0}, {thick_m, y - thick_m, high_m});
  add_box(mesh, {x - thick_m, thick_m, 0}, {x, y - thick_m, high_m});
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
  const World world = imported(mesh);
  const RouteProposal proposal = propose_route(FloorPlan(world, 1.2));
  ASSERT_GT(route_length_m(proposal.route), 8);
  EXPECT_FALSE(enters(proposal, 4.4, 3.4, 6.6, 4.6));
  EXPECT_FALSE(enters(proposal, 9.1, 0, 12, 8));
}

// A gallery of 3 m around a void that is larger than it.
TEST(ProposedRoute, KeepsToAGalleryAroundAVoid) {
  Mesh mesh;
  add_box(mesh, {-0.1, -0.1, 0}, {20.1, 0, 2.6});
  add_box(mesh, {-0.1, 20, 0}, {20.1, 20.1, 2.6});
  add_box(mesh, {-0.1, 0, 0}, {0, 20, 2.6});
  add_box(mesh, {20, 0, 0}, {20.1, 20, 2.6});
  add_rectangle(mesh, {0, 0, 0}, {20, 0, 0}, {0, 3, 0});
  add_rectangle(mesh, {0, 17, 0}, {20, 0, 0}, {0, 3, 0});
  add_rectangle(mesh, {0, 3, 0}, {3, 0, 0}, {0, 14, 0});
  add_rectangle(mesh, {17, 3, 0}, {3, 0, 0}, {0, 14, 0});
  const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
  EXPECT_GT(route_length_m(proposal.route), 50);
  EXPECT_FALSE(enters(proposal, 3.4, 3.4, 16.6, 16.6));
  EXPECT_NEAR(proposal.floor_m2, 400 - 196, 25);
  EXPECT_NEAR(proposal.level_m2, 196, 25);
}

/// A plot of 30 x 20 m with two houses that are solid blocks, one of two that overlap;
/// `has_ground_below` if the ground goes on below them. A fence 1.8 m high with a gate of this
/// width; none for a width below 0.
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
  add_box(mesh, {17, 10, 0}, {21, 17, 4});  // with which it is an L
  if (gate_m >= 0) add_walls_around(mesh, {30, 20}, 0.1, 1.8, 12, gate_m);
  return imported(mesh);
}

// Property: on a plot the route is in the yard, never inside of a solid house, and its openness is
// told.
TEST(ProposedRoute, KeepsOutOfSolidBodies) {
  for (const bool has_ground_below : {false, true}) {
    for (const double gate_m : {-1.0, 0.0, 1.5, 3.2}) {
      const World world = plot(has_ground_below, gate_m);
      const RouteProposal proposal = propose_route(FloorPlan(world, 1.2));
      ASSERT_GT(route_length_m(proposal.route), 60) << has_ground_below << ' ' << gate_m;
      EXPECT_FALSE(enters(proposal, 4, 4, 13, 13));
      EXPECT_FALSE(enters(proposal, 17, 4, 26, 13));
      EXPECT_FALSE(enters(proposal, 17, 10, 21, 17));
      EXPECT_NEAR(proposal.floor_m2, 600 - 162 - 16, 60);
      // Bottoms that became part of the ground around leave shells, which may be rooms.
      EXPECT_NEAR(proposal.other_m2, has_ground_below ? 0 : 162 + 16 - 37, 10);
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

/// A house of 8 x 6 m of walls that are single sheets and face outwards, with a door or gap of this
/// width, on ground that goes on by 10 m.
Mesh house_of_sheets(double door_m) {
  Mesh mesh;
  add_rectangle(mesh, {-10, -10, 0}, {28, 0, 0}, {0, 26, 0});
  add_rectangle(mesh, {0, 0, 0}, {3, 0, 0}, {0, 0, 2.6});
  add_rectangle(mesh, {3 + door_m, 0, 0}, {5 - door_m, 0, 0}, {0, 0, 2.6});
  add_rectangle(mesh, {0, 6, 0}, {0, 0, 2.6}, {8, 0, 0});
  add_rectangle(mesh, {0, 0, 0}, {0, 0, 2.6}, {0, 6, 0});
  add_rectangle(mesh, {8, 0, 0}, {0, 6, 0}, {0, 0, 2.6});
  add_rectangle(mesh, {0, 0, 2.6}, {8, 0, 0}, {0, 6, 0});
  return mesh;
}

// What has a door is no solid body, though its walls look like the outside of one.
TEST(ProposedRoute, IsInAHouseOfSheetsWithADoor) {
  const RouteProposal proposal = propose_route(FloorPlan(imported(house_of_sheets(0.9)), 1.2));
  EXPECT_FALSE(proposal.is_open);
  EXPECT_NEAR(proposal.floor_m2, 48 - 4, 4);
}

// Without ground around, the floor of a house of sheets with a gap of 3 m is all there is: its gap
// is told.
TEST(ProposedRoute, SaysHowARoomWithoutThicknessIsOpen) {
  Mesh mesh = house_of_sheets(3);
  for (int i = 0; i < 4; ++i) {
    mesh.vertices[i] = Eigen::Vector3d(i == 1 || i == 2 ? 8 : 0, i < 2 ? 0 : 6, 0);
  }
  const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
  EXPECT_TRUE(proposal.is_open);
  EXPECT_NEAR(proposal.gap_m, 3, 0.3);
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

// A block with its faces turned inwards may be a room: the yard is larger, and the block is told.
TEST(ProposedRoute, KeepsOutOfASmallerBlockTurnedInsideOut) {
  for (const double gate_m : {-1.0, 0.0, 2.8}) {
    Mesh mesh;
    add_box(mesh, {8, 5, 0}, {20, 13, 4});
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    add_rectangle(mesh, {0, 0, 0}, {26, 0, 0}, {0, 18, 0});
    if (gate_m >= 0) add_walls_around(mesh, {26, 18}, 0.1, 2, 5, gate_m);
    const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
    EXPECT_GT(route_length_m(proposal.route), 60);
    EXPECT_FALSE(enters(proposal, 8, 5, 20, 13)) << gate_m;
    EXPECT_NEAR(proposal.other_m2, 96 - 5, 6) << gate_m;
  }
}

/// A hall of 28 x 16 m on a floor of its own with a gate of this width, and a store of 5 x 4 m in
/// its corner with a door or without.
Mesh hall(double gate_m, bool has_door) {
  Mesh mesh;
  add_rectangle(mesh, {0, 0, 0}, {28, 0, 0}, {0, 16, 0});
  add_walls_around(mesh, {28, 16}, 0.2, 5, 9, gate_m);
  add_box(mesh, {22, 11, 0}, {24, 11.1, 2.5});
  add_box(mesh, {has_door ? 24.9 : 24, 11, 0}, {28, 11.1, 2.5});
  add_box(mesh, {22, 11.1, 0}, {22.1, 15.8, 2.5});
  return mesh;
}

// Property: shelves that make the hall narrow, so that most of it is enclosed by gaps of 2 m, do
// not make the floor at its gate a part of the outside.
TEST(ProposedRoute, IsInAllOfAHallWithShelves) {
  Mesh mesh = hall(4.2, true);
  for (const double y : {3.5, 6.0, 8.5}) add_box(mesh, {2, y, 0}, {26, y + 0.6, 2});
  const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
  EXPECT_NEAR(proposal.gap_m, 4.2, 0.7);  // shelves close most of the hall to less already
  EXPECT_TRUE(enters(proposal, 8, 0.2, 14, 3));
  EXPECT_NEAR(proposal.floor_m2, 28 * 16 - 3 * 24 * 0.6 - 3 * 50 * 0.15, 60);
}

// Property: a hall with a wide gate is not given up for a small room that is enclosed.
TEST(ProposedRoute, IsInAHallWithAGateBesideAnEnclosedRoom) {
  for (const double gate_m : {2.6, 5.0, 7.0}) {
    for (const bool has_door : {false, true}) {
      const RouteProposal proposal =
          propose_route(FloorPlan(imported(hall(gate_m, has_door)), 1.2));
      EXPECT_TRUE(proposal.is_open);
      EXPECT_NEAR(proposal.gap_m, gate_m, 0.35);
      EXPECT_NEAR(proposal.floor_m2 + proposal.other_m2, 28 * 16, 50);
      EXPECT_NEAR(proposal.other_m2, has_door ? 0 : 5.7 * 4.7, 5) << gate_m;
      EXPECT_EQ(enters(proposal, 22.1, 11.1, 28, 16), has_door);
    }
  }
}

// Property: floor in front of a gate, as far as it goes, does not close the way around the hall.
TEST(ProposedRoute, IsInAHallWithAnApron) {
  for (const double apron_m : {1.0, 2.0, 6.0}) {
    Mesh mesh = hall(5, true);
    add_rectangle(mesh, {0, -apron_m, 0}, {28, 0, 0}, {0, apron_m, 0});
    add_rectangle(mesh, {0, 16, 0}, {28, 0, 0}, {0, 1, 0});
    const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
    EXPECT_NEAR(proposal.floor_m2, 28 * 16, 50) << apron_m;
    EXPECT_NEAR(proposal.gap_m, 5, 0.35) << apron_m;
    EXPECT_FALSE(enters(proposal, 0, 16.2, 28, 17)) << apron_m;
  }
}

// Where the rooms have ceilings, a garden behind the gate of its fence is none.
TEST(ProposedRoute, KeepsAGardenBehindAGateApart) {
  Mesh mesh = house_of_sheets(0.9);
  add_box(mesh, {-10, -10, 0}, {0, -9.9, 1.8});
  add_box(mesh, {4, -10, 0}, {18, -9.9, 1.8});
  add_box(mesh, {-10, 15.9, 0}, {18, 16, 1.8});
  add_box(mesh, {-10, -9.9, 0}, {-9.9, 15.9, 1.8});
  add_box(mesh, {17.9, -9.9, 0}, {18, 15.9, 1.8});
  const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
  EXPECT_FALSE(proposal.is_open);
  EXPECT_NEAR(proposal.floor_m2, 48 - 4, 4);
}

// A house whose only gap is wider than a door is not given up for the ground.
TEST(ProposedRoute, IsInAHouseWithATerraceDoorAlone) {
  const RouteProposal proposal = propose_route(FloorPlan(imported(house_of_sheets(3)), 1.2));
  EXPECT_NEAR(proposal.floor_m2, 48 - 4, 4);
  EXPECT_NEAR(proposal.gap_m, 3, 0.35);
}

// A niche in a wall of a house, and ground around it, are not floor behind a gate.
TEST(ProposedRoute, StaysInAHouseBesideANiche) {
  Mesh mesh = test::house();
  add_rectangle(mesh, {-12, -12, 0}, {32, 0, 0}, {0, 27, 0});
  add_box(mesh, {8.2, -4, 0}, {8.3, 0, 2.5});
  add_box(mesh, {-0.2, -4, 0}, {-0.1, 0, 2.5});
  const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
  EXPECT_FALSE(proposal.is_open);
  EXPECT_NEAR(proposal.floor_m2, 8 * 2.7, 4);
  EXPECT_NEAR(proposal.open_m2, 32 * 27 - 8.3 * 3.2, 30);
}

// Whether a closed house of sheets is a block cannot be known: it is the larger part here.
TEST(ProposedRoute, IsInAClosedHouseOfSheetsLargerThanItsTerrace) {
  Mesh mesh;
  add_rectangle(mesh, {0, 0, 0}, {9, 0, 0}, {0, 7, 0});
  add_rectangle(mesh, {0, -2.5, 0}, {9, 0, 0}, {0, 2.5, 0});
  add_rectangle(mesh, {0, 0, 0}, {9, 0, 0}, {0, 0, 2.6});
  add_rectangle(mesh, {0, 7, 0}, {0, 0, 2.6}, {9, 0, 0});
  add_rectangle(mesh, {0, 0, 0}, {0, 0, 2.6}, {0, 7, 0});
  add_rectangle(mesh, {9, 0, 0}, {0, 7, 0}, {0, 0, 2.6});
  add_rectangle(mesh, {0, 0, 2.6}, {9, 0, 0}, {0, 7, 0});
  const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
  EXPECT_FALSE(proposal.is_open);
  EXPECT_NEAR(proposal.floor_m2, 63 - 4, 4);
  EXPECT_NEAR(proposal.other_m2, 9 * 2.5, 4);
  EXPECT_FALSE(enters(proposal, 0, -3, 9, 0));
}

// On ground that goes on below its walls it is not entered.
TEST(ProposedRoute, KeepsOutOfAClosedHouseOfSheetsOnGround) {
  const RouteProposal proposal = propose_route(FloorPlan(imported(house_of_sheets(0)), 1.2));
  EXPECT_TRUE(proposal.is_open);
  EXPECT_FALSE(enters(proposal, 0, 0, 8, 6));
  EXPECT_NEAR(proposal.other_m2, 48 - 4, 4);  // and told, since it may be a room
}

// A room of which a part is lower, or higher.
TEST(ProposedRoute, SaysWhatIsAtAnotherLevel) {
  for (const double level_m : {-0.18, 0.0, 0.18}) {
    Mesh mesh;
    add_rectangle(mesh, {0, 0, 0}, {8, 0, 0}, {0, 7, 0});
    add_rectangle(mesh, {8, 0, level_m}, {4, 0, 0}, {0, 7, 0});
    add_rectangle(mesh, {8, 0, std::min(0.0, level_m)}, {0, 7, 0}, {0, 0, std::abs(level_m)});
    add_box(mesh, {-0.1, -0.1, -0.2}, {12.1, 0, 2.6});
    add_box(mesh, {-0.1, 7, -0.2}, {12.1, 7.1, 2.6});
    add_box(mesh, {-0.1, 0, -0.2}, {0, 7, 2.6});
    add_box(mesh, {12, 0, -0.2}, {12.1, 7, 2.6});
    const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
    EXPECT_NEAR(proposal.floor_m2, (level_m == 0 ? 12 : 8) * 7, 6) << level_m;
    EXPECT_NEAR(proposal.level_m2, level_m == 0 ? 0 : 4 * 7, 4) << level_m;
  }
}

TEST(ProposedRoute, SaysThatItIsCutShort) {
  const FloorPlan plan(imported(hall(2.6, true)), 1.2);
  EXPECT_FALSE(propose_route(plan).is_cut_short);
  const RouteProposal proposal = propose_route(plan, 3);
  EXPECT_EQ(proposal.route.size(), 3u);
  EXPECT_TRUE(proposal.is_cut_short);
  EXPECT_LT(proposal.near_m2, 0.7 * proposal.floor_m2);
}

// Where no floor is and nothing is enclosed, a robot would drive over nothing.
TEST(ProposedRoute, IsEmptyWithoutFloor) {
  Mesh mesh;
  add_box(mesh, {0, 0, 0}, {0.3, 0.3, 2.5});
  add_rectangle(mesh, {0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0});
  EXPECT_TRUE(propose_route(FloorPlan(imported(mesh), 1.2)).route.empty());
}

// Walls alone, as in a drawing, are enough; outside of them nothing is known of a floor.
TEST(ProposedRoute, IsWithinWallsThatHaveNoFloor) {
  Mesh mesh = hall(4, true);
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 2);
  const RouteProposal proposal = propose_route(FloorPlan(imported(mesh), 1.2));
  EXPECT_GT(route_length_m(proposal.route), 60);
  EXPECT_NEAR(proposal.floor_m2, 28 * 16, 50);
  EXPECT_FALSE(enters(proposal, -3, -3, 31, -0.3));
}

}  // namespace
}  // namespace vernier::sim::internal
