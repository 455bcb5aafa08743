// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/experiment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/study/standing_place.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

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

// Of 4,000 draws and of 40,000 uniform poses weighted by the density, the shares in a quarter of
// the floor and of the headings agree within four standard deviations (false alarms 1e-4 a
// protocol).
TEST(QueryProtocol, ItsDensityIsThatOfItsDraws) {
  const Visibility& visibility = test::small_office_visibility();
  const WorldExtent box = standing_box(test::small_office());
  for (const auto protocol : {QueryProtocol::path, QueryProtocol::anywhere, QueryProtocol::free}) {
    const QueryPlaces places(visibility, protocol, 1.2);
    const Pose2D apart = places.draw(5, 99'999);
    const auto inside = [&](const Pose2D& p) {
      return p.x_m < apart.x_m && std::sin(p.heading_rad) > 0;
    };
    constexpr int draws = 4000, uniform = 40'000;
    int drawn = 0;
    for (std::uint32_t trial = 0; trial < draws; ++trial) {
      const Pose2D pose = places.draw(5, trial);
      EXPECT_GE(places.density(pose), 1) << trial;
      drawn += inside(pose);
    }
    RandomStream stream({.seed = 6});
    double all = 0, some = 0, all_squared = 0;
    for (int i = 0; i < uniform; ++i) {
      const Pose2D pose{stream.uniform(box.low_m.x(), box.high_m.x()),
                        stream.uniform(box.low_m.y(), box.high_m.y()),
                        stream.uniform(-std::numbers::pi, std::numbers::pi)};
      const double weight = places.density(pose);
      all += weight;
      all_squared += weight * weight;
      if (inside(pose)) some += weight;
    }
    const double share = some / all, effective = all * all / all_squared;
    EXPECT_GT(effective, 200);
    const double sigma = std::sqrt(share * (1 - share) * (1 / effective + 1.0 / draws));
    EXPECT_NEAR(1.0 * drawn / draws, share, 4 * sigma) << name(protocol);
  }
}

// Two straight parts that meet at a right angle: inside the bend a pose may be drawn from both,
// outside it from none; headings around half a turn are near each other.
TEST(QueryProtocol, ItsDensityCountsTheStraightPartsAPoseIsDrawnFrom) {
  WorldDescription d;
  d.loose.segments_m.push_back({{-5, -5, 0}, {-5, -5, 2}});
  d.loose.segments_m.push_back({{5, 5, 0}, {5, 5, 2}});
  d.route.push_back({{{2, 0}, {0, 0}, {0, 2}}});
  const World world = build_world(d);
  const Visibility visibility(world);
  constexpr double half_turn = std::numbers::pi;
  const auto of = [&](QueryProtocol protocol, const Pose2D& pose) {
    return QueryPlaces(visibility, protocol, 1.2).density(pose);
  };
  EXPECT_EQ(of(QueryProtocol::anywhere, {0.3, 0.4, 1}), 2);
  EXPECT_EQ(of(QueryProtocol::anywhere, {-0.1, -0.1, 1}), 0);
  EXPECT_EQ(of(QueryProtocol::anywhere, {0, 2.1, 1}), 0);
  EXPECT_EQ(of(QueryProtocol::near_path, {1, 0.09, half_turn - 0.08}), 1);
  EXPECT_EQ(of(QueryProtocol::near_path, {1, 0.09, 0.08 - half_turn}), 1);
  EXPECT_EQ(of(QueryProtocol::near_path, {1, 0.09, 0.1 - half_turn}), 0);
  EXPECT_EQ(of(QueryProtocol::near_path, {1, 0.11, half_turn}), 0);
  EXPECT_EQ(of(QueryProtocol::near_path, {1, 0, 0}), 0);
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

/// Four upright faces and a lid.
void add_box(WorldDescription& world, double x, double y, double dx, double dy, double height) {
  const Eigen::Vector2d corners[] = {{x, y}, {x + dx, y}, {x + dx, y + dy}, {x, y + dy}};
  std::vector<Eigen::Vector3d> lid;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
    world.loose.segments_m.push_back({{a.x(), a.y(), 0}, {a.x(), a.y(), height}});
    world.loose.surfaces_m.push_back(
        {{a.x(), a.y(), 0}, {b.x(), b.y(), 0}, {b.x(), b.y(), height}, {a.x(), a.y(), height}});
    lid.emplace_back(a.x(), a.y(), height);
  }
  world.loose.surfaces_m.push_back(lid);
}

// A room of 6 x 4 m with a cupboard of 1 x 1 m, a table, and a screen that hides a part of it from
// the route but can be walked around.
TEST(StandingFault, NamesWhyACameraCannotBeThere) {
  WorldDescription description;
  add_box(description, 0, 0, 6, 4, 2.5);
  add_box(description, 4, 2, 1, 1, 2);
  add_box(description, 2, 2.5, 0.6, 0.6, 0.7);
  description.loose.surfaces_m.push_back({{1, 1.5, 0}, {1, 4, 0}, {1, 4, 2.5}, {1, 1.5, 2.5}});
  description.route.push_back({{{1.5, 1.8}, {3, 1.8}}});
  description.route.push_back({{{2, 0.4}, {5.6, 0.4}}});  // nearer to the walls than poses lie off
  const World world = build_world(description);
  const Visibility visibility(world);
  const auto fault = [&](double x, double y, double height) {
    return standing_fault(visibility, {x, y, 0}, height);
  };
  EXPECT_EQ(fault(2, 1, 1.2), "");
  EXPECT_EQ(fault(0.5, 3.5, 1.2), "");  // behind the screen
  EXPECT_EQ(fault(5.5, 2.5, 1.2), "");  // behind the cupboard
  EXPECT_EQ(fault(4.5, 2.5, 1.2),
            "is not reachable from the route, as inside a wall or a cupboard");
  EXPECT_NE(fault(2.3, 2.8, 1.2).find("has a surface nearer than 0.12 m"), std::string::npos);
  EXPECT_NE(fault(0.05, 2, 1.2).find("has a surface nearer than 0.12 m"), std::string::npos);
  EXPECT_NE(fault(2, 1, 2.4).find("less than 0.2 m above the camera"), std::string::npos);
  EXPECT_EQ(fault(7, 1, 1.2), "is outside the world, which extends from (0, 0) to (6, 4) m");
  EXPECT_EQ(fault(2, 1, 3), "is at a height of 3 m, above the ceiling at 2.5 m");
  EXPECT_EQ(fault(2, 1, -1), "is at a height of -1 m, below the floor at 0 m");
  EXPECT_NE(fault(std::nan(""), 1, 1.2), "");
}

/// Four edges beyond the end of a route, lower than the camera: no walls and no ceiling.
WorldDescription low_world() {
  WorldDescription description;
  for (const double x : {4.0, 5.0}) {
    for (const double y : {-0.5, 0.5}) {
      description.loose.segments_m.push_back({{x, y, 0}, {x, y, 0.8}});
    }
  }
  description.route.push_back({{{0, 0}, {1, 0}}});
  return description;
}

TEST(StandingFault, APoseOnTheRouteHasNoneWhateverTheWorldsEdges) {
  WorldDescription with_table = low_world(), of_surfaces = low_world(), high_up = low_world();
  add_box(with_table, 2, 1, 0.6, 0.6, 0.7);
  of_surfaces.loose.segments_m.clear();
  of_surfaces.loose.surfaces_m.push_back({{4, -1, 0}, {4, 1, 0}, {4, 1, 0.5}, {4, -1, 0.5}});
  for (auto& [a, b] : high_up.loose.segments_m) {
    a.z() += 2;
    b.z() += 2;
  }
  for (const WorldDescription& description : {low_world(), with_table, of_surfaces, high_up}) {
    const World world = build_world(description);
    const Visibility visibility(world);
    for (double s = 0; s < 1; s += 0.25) {
      EXPECT_EQ(standing_fault(visibility, route_point(world.route, s).pose, 1.2), "") << s;
    }
    for (std::uint32_t trial = 0; trial < 20; ++trial) {
      const Pose2D q = draw_query(visibility, QueryProtocol::anywhere, 1.2, 5, trial);
      EXPECT_EQ(standing_fault(visibility, q, 1.2), "") << q.x_m << ' ' << q.y_m;
    }
    EXPECT_EQ(standing_fault(visibility, {3, 0, 0}, 1.2), "");  // between route and edges
    EXPECT_NE(standing_fault(visibility, {-1, 0, 0}, 1.2).find("outside the world"),
              std::string::npos);
    EXPECT_NE(standing_fault(visibility, {0, 0, 0}, -0.1).find("below the floor"),
              std::string::npos);
  }
  const World world = build_world(with_table);
  EXPECT_EQ(standing_fault(Visibility(world), {2.3, 1.3, 0}, 1.2),
            "is at a height of 1.2 m, above the ceiling at 0.7 m");
}

TEST(StandingFault, QueriesHaveNone) {
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    const Pose2D q =
        draw_query(test::small_office_visibility(), QueryProtocol::anywhere, 1.2, 5, trial);
    EXPECT_EQ(standing_fault(test::small_office_visibility(), q, 1.2), "");
  }
}

/// A room of 6 x 4 m with a cupboard of 1 x 1 m, beside a closed room without a way to the route.
World room_with_cupboard() {
  WorldDescription description;
  add_box(description, 0, 0, 6, 4, 2.5);
  add_box(description, 4, 2, 1, 1, 2);
  add_box(description, 6.2, 0, 4, 4, 2.5);
  description.route.push_back({{{1, 1}, {3, 1}}});
  return build_world(description);
}

/// Whether a robot of 0.12 m fits into the room, by its plan.
bool fits_into_room(double x, double y) {
  const double dx = std::max({4 - x, x - 5, 0.0}), dy = std::max({2 - y, y - 3, 0.0});
  return x > 0.12 && x < 5.88 && y > 0.12 && y < 3.88 && std::hypot(dx, dy) > 0.12;
}

/// Pearson's statistic is beyond this by chance with a probability of 1e-6.
double limit(std::size_t cells) {
  return chi_squared_quantile(1 - 1e-6, static_cast<double>(cells) - 1);
}

// Seed 5. The free area of each square of 0.5 m is counted on a lattice of 5 mm.
TEST(QueryProtocol, FreeIsUniformOverTheFloorAndTheHeadings) {
  const World world = room_with_cupboard();
  const Visibility visibility(world);
  const QueryPlaces places(visibility, QueryProtocol::free, 1.2);
  std::vector<double> area(12 * 8, 0), count(12 * 8, 0), sectors(16, 0);
  const auto square = [](double x, double y) {
    return static_cast<std::size_t>(std::floor(x / 0.5) + 12 * std::floor(y / 0.5));
  };
  double all = 0;
  for (double x = 0.0025; x < 6; x += 0.005) {
    for (double y = 0.0025; y < 4; y += 0.005) {
      if (!fits_into_room(x, y)) continue;
      ++area[square(x, y)];
      ++all;
    }
  }
  constexpr int trials = 20'000;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const Pose2D q = places.draw(5, trial);
    ASSERT_TRUE(fits_into_room(q.x_m, q.y_m)) << q.x_m << ' ' << q.y_m;
    ++count[square(q.x_m, q.y_m)];
    const double turn = (q.heading_rad + std::numbers::pi) / (2 * std::numbers::pi);
    ++sectors[std::min<std::size_t>(15, static_cast<std::size_t>(16 * turn))];
  }
  double of_places = 0, of_headings = 0;
  std::size_t cells = 0;
  for (std::size_t i = 0; i < area.size(); ++i) {
    const double expected = trials * area[i] / all;
    if (expected < 1) continue;  // within the cupboard
    of_places += (count[i] - expected) * (count[i] - expected) / expected;
    ++cells;
  }
  for (const double n : sectors)
    of_headings += (n - trials / 16.) * (n - trials / 16.) * 16 / trials;
  EXPECT_LT(of_places, limit(cells));
  EXPECT_LT(of_headings, limit(16));
  EXPECT_EQ(places.draw(5, 3).x_m, places.draw(5, 3).x_m);
  EXPECT_NE(places.draw(5, 3).x_m, places.draw(6, 3).x_m);
}

TEST(QueryProtocol, FreePlacesInAnOfficeAreWhereARobotCanStand) {
  const Visibility& visibility = test::small_office_visibility();
  const QueryPlaces places(visibility, QueryProtocol::free, 1.2);
  int far = 0;
  for (std::uint32_t trial = 0; trial < 100; ++trial) {
    const Pose2D q = places.draw(5, trial);
    EXPECT_TRUE(is_free(test::small_office(), {q.x_m, q.y_m}, 0.12, 1.4));
    EXPECT_EQ(standing_fault(visibility, q, 1.2), "");
    far += from_route(q, 0.6).first > 0.62;
  }
  EXPECT_GT(far, 10);  // farther from the route than any other protocol asks
}

TEST(QueryProtocol, FreeNeedsAFloorWithAnEnd) {
  WorldDescription description = low_world();
  description.route = {{{{0, 0}, {1000, 1000}}}};
  const World world = build_world(description);
  const Visibility visibility(world);
  EXPECT_THROW(QueryPlaces(visibility, QueryProtocol::free, 1.2).draw(5, 0), Error);
}

TEST(QueryProtocol, NamesRoundTrip) {
  EXPECT_EQ(query_protocol("free"), QueryProtocol::free);
  EXPECT_EQ(query_protocol("anywhere"), QueryProtocol::anywhere);
  EXPECT_THROW(query_protocol("somewhere"), Error);
}

}  // namespace
}  // namespace vernier
