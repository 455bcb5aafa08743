// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/blocked_route.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "sim/study/standing_place.h"
#include "sim/world.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace sim;
using namespace vernier::sim::internal;

namespace {

World with_route(std::vector<Eigen::Vector2d> points_m) {
  World world = test::small_office();
  world.route.assign(1, RouteLeg{});
  world.route[0].points_m = std::move(points_m);
  return world;
}

TEST(BlockedRoute, IsNoneOfAnOfficesOwnRoute) {
  const BlockedRoute route = blocked_route(test::small_office(), 1.2);
  EXPECT_GT(route.places, 50);
  EXPECT_EQ(route.blocked, 0);
  EXPECT_TRUE(route_fault(test::small_office(), 1.2).fault.empty());
}

// Straight across the building, through its walls: by brute force over the same places.
TEST(BlockedRoute, CountsThePlacesInWalls) {
  const WorldExtent box = standing_box(test::small_office());
  const Eigen::Vector2d from(box.low_m.x(), 0.4 * box.high_m.y()), to(box.high_m.x(), from.y());
  const World world = with_route({from, to});
  const BlockedRoute route = blocked_route(world, 1.2);
  const int steps = route.places - 1;
  int blocked = 0;
  for (int i = 0; i <= steps; ++i) {
    blocked += !is_free(world, from + (to - from) * i / steps, robot_radius_m, 1.2 + robot_top_m);
  }
  EXPECT_GT(blocked, 3);
  EXPECT_LT(blocked, steps);
  EXPECT_EQ(route.blocked, blocked);
  EXPECT_FALSE(route.is_too_high);
  EXPECT_NE(route_fault(world, 1.2).fault.find("leads through something in "), std::string::npos);
}

TEST(BlockedRoute, SaysThatACameraIsTooHigh) {
  EXPECT_TRUE(blocked_route(test::small_office(), 2.4).is_too_high);
  const RouteFault route = route_fault(test::small_office(), 2.4);
  EXPECT_NE(route.fault.find("lower than 2.6 m everywhere"), std::string::npos) << route.fault;
  EXPECT_EQ(route.remedy, "lower the camera");
}

TEST(BlockedRoute, SaysThatAWorldIsAboveTheFloor) {
  const auto raised = [](double by_m) {
    World world = test::small_office();
    for (WorldSegment& segment : world.segments) {
      segment.a_m.z() += by_m;
      segment.b_m.z() += by_m;
    }
    for (WorldSurface& surface : world.surfaces) {
      for (Eigen::Vector3d& point : surface.polygon_m) point.z() += by_m;
    }
    return world;
  };
  EXPECT_TRUE(route_fault(raised(0.01), 1.2).fault.empty());
  for (const double by_m : {0.07, 0.3, 1.0, 1.5, 3.2}) {
    const RouteFault route = route_fault(raised(by_m), 1.2);
    EXPECT_NE(route.fault.find(fmt::format("begins at z = {:g} m", by_m)), std::string::npos)
        << route.fault;
    EXPECT_NE(route.remedy.find("shift the world down"), std::string::npos);
    EXPECT_GT(route.share, 0.9) << by_m;
  }
}

TEST(BlockedRoute, NeedsARoute) { EXPECT_EQ(blocked_route(with_route({}), 1.2).places, 0); }

}  // namespace
}  // namespace vernier
