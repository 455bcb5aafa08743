// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/query_protocol.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/error.h"
#include "localise/place.h"
#include "sim/route.h"
#include "sim/world.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::localise;
using namespace vernier::sim;

namespace {

/// Least distance on the floor from the route, and least turn from the direction of travel among
/// the route's points within `across_m`, by dense sampling: of two legs that are both near, either
/// may be the one the query was drawn on.
std::pair<double, double> from_route(const Pose2D& query, double across_m) {
  const auto& route = test::small_office().route;
  double nearest = 1e9, turn = 1e9;
  for (double s = 0; s < route_length_m(route); s += 0.005) {
    const Pose2D p = route_point(route, s).pose;
    const double d = distance_m(p, query);
    nearest = std::min(nearest, d);
    if (d <= across_m) turn = std::min(turn, std::abs(heading_difference_rad(p, query)));
  }
  return {nearest, turn};
}

// Seed 5. Of 40 uniform draws the widest is beyond half the span but for odds of 1e-12.
TEST(QueryProtocol, QueriesStayInTheirSpanAndFillIt) {
  for (const auto protocol : {QueryProtocol::near_path, QueryProtocol::path}) {
    const ProtocolSpan reach = span(protocol);
    double widest_m = 0, widest_rad = 0;
    for (std::uint32_t trial = 0; trial < 40; ++trial) {
      const Pose2D q = draw_query(test::small_office_visibility(), protocol, 1.2, 5, trial);
      const auto [distance, turn] = from_route(q, reach.across_m + 0.02);
      EXPECT_LE(distance, reach.across_m + 0.02);
      EXPECT_LE(turn, reach.heading_rad + 1e-9);
      EXPECT_TRUE(is_free(test::small_office(), {q.x_m, q.y_m}, 0.12, 1.4));
      widest_m = std::max(widest_m, distance);
      widest_rad = std::max(widest_rad, turn);
    }
    EXPECT_GT(widest_m, reach.across_m / 2);
    EXPECT_GT(widest_rad, reach.heading_rad / 2);
  }
}

TEST(QueryProtocol, TheSameTrialAsksInTheSamePlace) {
  const auto draw = [](std::uint32_t trial) {
    return draw_query(test::small_office_visibility(), QueryProtocol::path, 1.2, 5, trial);
  };
  EXPECT_EQ(draw(3).x_m, draw(3).x_m);
  EXPECT_NE(draw(3).x_m, draw(4).x_m);
}

TEST(QueryProtocol, WallsAreNotFree) {
  const World& world = test::small_office();
  const Eigen::Vector2d outside(-0.05, 3);
  EXPECT_FALSE(is_free(world, outside, 0.12, 1.4));
  const Eigen::Vector2d on_route = world.route[0].points_m[0];
  EXPECT_TRUE(is_free(world, on_route, 0.12, 1.4));
}

TEST(QueryProtocol, NamesRoundTrip) {
  EXPECT_EQ(query_protocol("anywhere"), QueryProtocol::anywhere);
  EXPECT_THROW(query_protocol("somewhere"), Error);
}

}  // namespace
}  // namespace vernier
