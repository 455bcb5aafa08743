// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/support/walls_and_boxes.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::sim;

namespace {

using namespace test;

/// How many edges of a box the camera sees; all of them must be seen in full.
int whole_edges(const World& world, const Vector3d& eye, const Vector3d& target) {
  const auto runs =
      Visibility(world).visible_intervals(camera_with(500, -0.1), looking_at(eye, target), {});
  for (const VisibleInterval& r : runs) {
    EXPECT_EQ(r.t0, 0);
    EXPECT_EQ(r.t1, 1);
    EXPECT_EQ(r.run, 0);
  }
  return static_cast<int>(runs.size());
}

TEST(VisibilityCases, BoxFromOutsideShowsTheEdgesOfItsFrontFaces) {
  const Vector3d size(1, 2, 1.5), centre = size / 2;
  World world;
  add_box(world, {}, size);
  EXPECT_EQ(whole_edges(world, {7, 5, 4}, centre), 9);      // three faces
  EXPECT_EQ(whole_edges(world, {-5, -7.3, 6}, centre), 9);  // three faces, the other side
  EXPECT_EQ(whole_edges(world, {6, 5, 0.7}, centre), 7);    // two faces
  EXPECT_EQ(whole_edges(world, {6, 0.9, 0.7}, centre), 4);  // one face
  // Edge-on to a face: its far edge is in line with its near edge, and behind no interior.
  EXPECT_EQ(whole_edges(world, {6, 5, 1.5}, centre), 7 + 2);
}

TEST(VisibilityCases, TurnedBoxesFromOutsideShowWholeEdges) {
  RandomStream draws({.seed = 43});
  for (int trial = 0; trial < 200; ++trial) {
    World world;
    const Pose T = random_pose(draws, {-9, -9, -1}, {9, 9, 1});
    const Vector3d size = random_point(draws, {0.5, 0.5, 0.5}, {2, 2, 2});
    add_box(world, T, size);
    const Vector3d eye = random_point(draws, {-20, -20, 3}, {20, 20, 6});
    const Vector3d x = T.inverse() * eye;
    int fronts = 0;
    for (int axis = 0; axis < 3; ++axis) fronts += x[axis] < 0 || x[axis] > size[axis];
    if (fronts == 0 || (eye - T * (size / 2)).norm() < 5) continue;
    const int expected[] = {0, 4, 7, 9};
    const auto runs = Visibility(world).visible_intervals(
        camera_with(500, 0), looking_at(eye, T * (size / 2)),
        {.far_m = 60, .min_length_px = 0.1, .surface_gap_m = 1e-6});
    ASSERT_EQ(runs.size(), expected[fronts]) << "trial " << trial;
    for (const VisibleInterval& r : runs) EXPECT_TRUE(r.t0 == 0 && r.t1 == 1);
  }
}

TEST(VisibilityCases, WallsOfARoomHideNothingInIt) {
  World room, wires;
  add_box(room, {}, {4, 5, 2.5});
  wires.segments = room.segments;
  const Vector3d eye(1.5, 2, 1.2);
  std::set<int> seen;
  for (int i = 0; i < 12; ++i) {
    const double heading = 0.2 + 0.5 * i, pitch = 0.3 * (i % 3 - 1);
    const Vector3d target = eye + Vector3d(std::cos(heading), std::sin(heading), pitch);
    const Camera camera = camera_with(300, -0.05);
    const Pose T = looking_at(eye, target);
    const auto inside = Visibility(room).visible_intervals(camera, T);
    const auto open = Visibility(wires).visible_intervals(camera, T);
    ASSERT_EQ(inside.size(), open.size());
    for (std::size_t k = 0; k < open.size(); ++k) {
      EXPECT_EQ(inside[k].segment, open[k].segment);
      EXPECT_EQ(inside[k].t0, open[k].t0);
      EXPECT_EQ(inside[k].t1, open[k].t1);
      seen.insert(open[k].segment);
    }
  }
  EXPECT_EQ(seen.size(), 12u);
}

TEST(VisibilityCases, DoorHoleShowsWhatIsBehindItOnly) {
  World world;
  add_surface(
      world,
      wall(2, {{-3, 0}, {-0.5, 0}, {-0.5, 2}, {0.5, 2}, {0.5, 0}, {3, 0}, {3, 2.5}, {-3, 2.5}}));
  world.segments.push_back({{-2, 4, 1}, {2, 4, 1}, 0});       // seen through the door from x = -1
  world.segments.push_back({{-2, 4, 3.2}, {2, 4, 3.2}, 0});   // behind the lintel
  world.segments.push_back({{0, 4, 0.5}, {0, 4, 1.5}, 0});    // all in the door
  world.segments.push_back({{-1.5, 4, 0}, {-1.5, 4, 2}, 0});  // behind the left part
  world.corners = {{{0, 4, 1}, 0}, {{1.5, 4, 1}, 0}};
  const Visibility visibility(world);
  const Pose T = looking_at({0, 0, 1}, {0, 2, 1});
  const auto runs = visibility.visible_intervals(camera_with(400, 0), T);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].segment, 0);
  EXPECT_NEAR(runs[0].t0, 0.25, 1e-12);  // the jambs at x = ±0.5, y = 2 are seen at ±1, y = 4
  EXPECT_NEAR(runs[0].t1, 0.75, 1e-12);
  EXPECT_EQ(runs[1].segment, 2);
  EXPECT_EQ(runs[1].t0, 0);
  EXPECT_EQ(runs[1].t1, 1);
  EXPECT_EQ(visibility.visible_corners(camera_with(400, 0), T), std::vector<int>{0});
}

TEST(VisibilityCases, HoleJoinedToTheBorderByACutIsOpen) {
  World world;  // a window in a wall; the border walks in to it and out again
  add_surface(world, wall(2, {{-3, 0},
                              {3, 0},
                              {3, 2.5},
                              {-3, 2.5},
                              {-3, 0},
                              {-0.5, 0.8},
                              {-0.5, 1.4},
                              {0.5, 1.4},
                              {0.5, 0.8},
                              {-0.5, 0.8}}));
  world.segments.push_back({{-2, 4, 1}, {2, 4, 1}, 0});
  world.segments.push_back({{-2, 4, 0.3}, {2, 4, 0.3}, 0});
  const auto runs =
      Visibility(world).visible_intervals(camera_with(400, 0), looking_at({0, 0, 1}, {0, 2, 1}));
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].segment, 0);
  EXPECT_NEAR(runs[0].t0, 0.25, 1e-12);
  EXPECT_NEAR(runs[0].t1, 0.75, 1e-12);
}

TEST(VisibilityCases, SegmentsNearAWallFollowTheGap) {
  World world;
  add_surface(world, wall(2, {{-3, 0}, {3, 0}, {3, 2.5}, {-3, 2.5}}));
  for (double y : {1.99, 2.01, 2.0001, 2.0, 2.0009, 2.0011}) {
    world.segments.push_back({{-0.5, y, 1}, {0.5, y, 1}, 0});
    world.corners.push_back({{0.2, y, 1}, 0});
  }
  const Visibility visibility(world);
  const Pose T = looking_at({0.3, -1, 1.3}, {0, 2, 1});
  const auto runs = visibility.visible_intervals(camera_with(500, 0), T);
  std::vector<int> seen;
  for (const VisibleInterval& r : runs) {
    seen.push_back(r.segment);
    EXPECT_TRUE(r.t0 == 0 && r.t1 == 1);
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 2, 3, 4}));
  EXPECT_EQ(visibility.visible_corners(camera_with(500, 0), T), (std::vector<int>{0, 2, 3, 4}));
  EXPECT_TRUE(visibility.sees({0.3, -1, 1.3}, {0, 2.0009, 1}));
  EXPECT_FALSE(visibility.sees({0.3, -1, 1.3}, {0, 2.0011, 1}));
  EXPECT_TRUE(visibility.sees({0.3, -1, 1.3}, {0, 2.0011, 1}, {.surface_gap_m = 2e-3}));
}

TEST(VisibilityCases, RunsAreNumberedBeforeShortOnesAreLeftOut) {
  World world;  // a fence of narrow slats before a line
  for (int i = 0; i < 5; ++i) {
    const double x = -1 + 0.5 * i;
    add_surface(
        world,
        wall(2, {{x, 0}, {x + (i == 2 ? 0.49 : 0.2), 0}, {x + (i == 2 ? 0.49 : 0.2), 2}, {x, 2}}));
  }
  world.segments.push_back({{-2, 4, 1}, {2, 4, 1}, 0});
  const Visibility visibility(world);
  const Pose T = looking_at({0, 0, 1}, {0, 2, 1});
  const auto all = visibility.visible_intervals(camera_with(400, 0), T, {.min_length_px = 0});
  const auto some = visibility.visible_intervals(camera_with(400, 0), T, {.min_length_px = 10});
  ASSERT_EQ(all.size(), 4u);
  ASSERT_EQ(some.size(), 3u);  // the gap of 1 cm is 2 px wide
  for (int i = 0; i < 4; ++i) EXPECT_EQ(all[i].run, i);
  EXPECT_EQ(some[2].run, 3);
  EXPECT_NEAR(some[2].t0, 0.5 + 1.4 / 4, 1e-12);
}

TEST(VisibilityCases, SeamsOfWallsDoNotLeakLight) {
  RandomStream draws({.seed = 44});
  for (int trial = 0; trial < 50; ++trial) {
    World world;  // a turned wall as a fan of triangles about an inner point, and lines behind
    const Pose T{rotation_from_vector({0, 0, draws.uniform(-0.6, 0.6)}), {0, 3, 0}};
    const Polygon border{{-9, 0, -9}, {0, 0, -9}, {9, 0, -9}, {9, 0, 1}, {9, 0, 9}, {-9, 0, 9}};
    const Vector3d hub{draws.uniform(-1, 1), 0, draws.uniform(-1, 1)};
    for (std::size_t i = 0; i < border.size(); ++i) {
      add_surface(world, {T * hub, T * border[i], T * border[(i + 1) % border.size()]});
    }
    for (int i = 0; i < 200; ++i) {
      const Vector3d a = T * random_point(draws, {-2, 0.01, -2}, {2, 3, 2});
      world.segments.push_back({a, T * random_point(draws, {-2, 0.01, -2}, {2, 3, 2}), 0});
    }
    const Vector3d eye{draws.uniform(-1, 1), 0, draws.uniform(-1, 1)};
    for (const Vector3d& spoke : border) {  // exactly behind the seams, up to rounding
      world.segments.push_back({eye + 1.2 * (T * hub - eye), eye + 1.2 * (T * spoke - eye), 0});
      world.corners.push_back({eye + 1.3 * (T * (hub + 0.1 * (spoke - hub)) - eye), 0});
    }
    world.corners.push_back({eye + 1.3 * (T * hub - eye), 0});
    const Visibility visibility(world);
    const Pose T_camera_world = looking_at(eye, {0, 3, 0});
    const VisibilityOptions options{.min_length_px = 0};
    EXPECT_TRUE(
        visibility.visible_intervals(camera_with(300, -0.05), T_camera_world, options).empty());
    EXPECT_TRUE(
        visibility.visible_corners(camera_with(300, -0.05), T_camera_world, options).empty());
    for (const WorldCorner& c : world.corners) EXPECT_FALSE(visibility.sees(eye, c.position_m));
  }
}

TEST(VisibilityCases, ALineInLineWithASingleEdgeIsSeen) {
  World world;  // the wall ends at x = 0, and the line stands in line with its end
  add_surface(world, wall(2, {{-3, -3}, {0, -3}, {0, 3}, {-3, 3}}));
  world.segments.push_back({{0, 4, 0}, {0, 4, 1}, 0});
  world.corners.push_back({{0, 4, 0.5}, 0});
  const Visibility visibility(world);
  const Pose T = looking_at({0, 0, 0.4}, {0, 2, 0.4});
  const auto runs = visibility.visible_intervals(camera_with(400, 0), T);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_TRUE(runs[0].t0 == 0 && runs[0].t1 == 1);
  EXPECT_EQ(visibility.visible_corners(camera_with(400, 0), T).size(), 1u);
  // The other half of the wall closes the sight, in its plane or another.
  for (double y : {2.0, 3.0}) {
    World closed = world;
    add_surface(closed, wall(y, {{0, -3}, {3, -3}, {3, 3}, {0, 3}}));
    EXPECT_TRUE(Visibility(closed).visible_intervals(camera_with(400, 0), T).empty());
    EXPECT_TRUE(Visibility(closed).visible_corners(camera_with(400, 0), T).empty());
  }
}

TEST(VisibilityCases, DepthsAreAlongTheAxis) {
  World world;
  world.segments.push_back({{0.1, -5, 0.05}, {0.1, 15, 0.05}, 0});
  const auto runs = Visibility(world).visible_intervals(
      camera_with(500, 0), looking_at({0, 0, 0}, {0, 1, 0}), {.near_m = 2, .far_m = 8});
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_NEAR(runs[0].t0, 7.0 / 20, 1e-12);
  EXPECT_NEAR(runs[0].t1, 13.0 / 20, 1e-12);
}

TEST(VisibilityCases, SurfacesWithoutAreaOrSeenEdgeOnHideNothing) {
  World world;
  world.segments.push_back({{-0.5, 4, 1}, {0.5, 4, 1}, 0});
  add_surface(world, {{-1, 2, 1}, {0, 2, 1}, {1, 2, 1}});
  add_surface(world, {{0, 2, 1}, {0, 2, 1}, {0, 2, 1}});
  add_surface(world, {{-1, 2, 1}, {1, 2, 1}});
  add_surface(world, {});
  add_surface(world, {{-1, 1, 1}, {1, 1, 1}, {1, 3, 1}, {-1, 3, 1}});  // in the eye's height
  add_surface(world, {{0, -1, 0}, {0, 1, 0}, {0, 1, 2}, {0, -1, 2}});  // the eye lies in it
  const auto runs =
      Visibility(world).visible_intervals(camera_with(500, 0), looking_at({0, 0, 1}, {0, 4, 1}));
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_TRUE(runs[0].t0 == 0 && runs[0].t1 == 1);
}

TEST(VisibilityCases, BadArgumentsAreNamed) {
  const World world;
  const Visibility visibility(world);
  const Pose T;
  EXPECT_TRUE(visibility.visible_intervals(camera_with(500, 0), T).empty());
  EXPECT_THROW(visibility.visible_intervals(camera_with(500, 0), T, {.near_m = 0}), Error);
  EXPECT_THROW(visibility.visible_intervals(camera_with(500, 0), T, {.near_m = 3, .far_m = 2}),
               Error);
  EXPECT_THROW(visibility.visible_intervals(camera_with(500, 0), T, {.surface_gap_m = -1}), Error);
  Camera short_of_one = camera_with(500, 0);
  short_of_one.parameters.conservativeResize(4);
  EXPECT_THROW(visibility.visible_intervals(short_of_one, T), Error);
}

// A real lens: barrel distortion whose polynomial folds just inside the image's corners. What lies
// beyond the fold is not imaged; the rest is seen as ever.
TEST(VisibilityCases, AFoldInsideTheCornersHidesOnlyWhatLiesBeyond) {
  World world;
  for (double x = -4; x <= 4; x += 0.5) world.segments.push_back({{x, 4, 0}, {x, 4, 3}, 0});
  const Visibility visibility(world);
  const Camera camera = camera_with(533, -0.29);
  ASSERT_FALSE(try_unproject(camera, {-0.5, -0.5}));
  const Pose T = looking_at({0, 0, 1.5}, {0, 4, 1.5});
  const auto runs = visibility.visible_intervals(camera, T);
  EXPECT_GT(runs.size(), 8u);
  for (const VisibleInterval& run : runs) {
    const WorldSegment& s = world.segments[run.segment];
    for (const double t : {run.t0, 0.5 * (run.t0 + run.t1), run.t1}) {
      const Eigen::Vector3d x = T * (s.a_m + t * (s.b_m - s.a_m));
      const Eigen::Vector2d pixel = project(camera, x);
      EXPECT_TRUE(in_image(camera, pixel - 1e-9 * Eigen::Vector2d::Ones()) ||
                  in_image(camera, pixel + 1e-9 * Eigen::Vector2d::Ones()));
      const auto ray = try_unproject(camera, pixel);
      ASSERT_TRUE(ray);
      EXPECT_LT((*ray - x / x.z()).norm(), 1e-6);  // the pixel's own ray: this side of the fold
    }
  }
}

}  // namespace
}  // namespace vernier
