// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <gtest/gtest.h>

#include <numbers>

#include "calib/error.h"

namespace vernier {

using namespace vernier::sim;

namespace {

const std::vector<RouteLeg> route{{{{0, 0}, {4, 0}, {4, 2}}}, {{{10, 10}, {10, 7}}}};

TEST(Route, PointsAlongAllLegs) {
  EXPECT_DOUBLE_EQ(route_length_m(route), 9);
  const RoutePoint p = route_point(route, 5);
  EXPECT_DOUBLE_EQ(p.pose.x_m, 4);
  EXPECT_DOUBLE_EQ(p.pose.y_m, 1);
  EXPECT_DOUBLE_EQ(p.pose.heading_rad, std::numbers::pi / 2);
  const RoutePoint q = route_point(route, 7.5);
  EXPECT_EQ(q.leg, 1);
  EXPECT_DOUBLE_EQ(q.pose.y_m, 8.5);
  EXPECT_DOUBLE_EQ(route_point(route, 100).pose.y_m, 7);
}

TEST(Route, MapPlacesAreEvenAndAtMostTheSpacingApart) {
  const auto places = map_poses(route, 0.5);
  EXPECT_EQ(places.size(), 8u + 4u + 6u);
  EXPECT_DOUBLE_EQ(places[1].x_m, 0.5);
  EXPECT_EQ(map_poses(route, 0.5, 8).size(), 8u * 18u);
}

TEST(Route, BadRequestsAreRefused) {
  EXPECT_THROW(map_poses({}, 0.5), Error);
  EXPECT_THROW(map_poses(route, 0), Error);
}

}  // namespace
}  // namespace vernier
