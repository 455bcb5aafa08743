// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/building.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "sim/buildings/office.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "tests/support/clear_route.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;
using test::connected_parts;
using test::expect_clear_route;

namespace {

using Eigen::Vector3d;
using Kinds = std::vector<BuildingKind>;

const std::vector<Kinds>& every_kind() {
  using enum BuildingKind;
  static const std::vector<Kinds> kinds{
      {office}, {home}, {hall}, {corridors}, {office, hall, home}, {corridors, home, home, office}};
  return kinds;
}

std::string names_of(const Kinds& kinds) {
  std::string name;
  for (const BuildingKind kind : kinds) name += " " + std::string(name_of(kind));
  return name;
}

TEST(Building, AnOfficeIsWhatItWas) {
  EXPECT_EQ(format_world(make_building(7)), format_world(make_office(7)));
}

TEST(Building, EveryKindIsAWorldThatReadsAsWritten) {
  for (const Kinds& kinds : every_kind()) {
    SCOPED_TRACE(names_of(kinds));
    const WorldDescription made = make_building(3, {kinds, {}});
    EXPECT_EQ(format_world(make_building(3, {kinds, {}})), format_world(made));
    EXPECT_NE(format_world(make_building(4, {kinds, {}})), format_world(made));
    EXPECT_EQ(format_world(parse_world(format_world(made), "text")), format_world(made));
    const World world = build_world(made);
    EXPECT_GT(world.segments.size(), 500u);
    EXPECT_GT(repeated_share(world), 0.3);
    EXPECT_GT(route_length_m(world.route), 10);
  }
}

TEST(Building, RoutesKeepClearOfEverything) {
  for (const Kinds& kinds : every_kind()) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(names_of(kinds) + " " + std::to_string(seed));
      expect_clear_route(build_world(make_building(seed, {kinds, {}})));
    }
  }
}

TEST(Building, LegsHangTogether) {
  for (const Kinds& kinds : every_kind()) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(names_of(kinds) + " " + std::to_string(seed));
      EXPECT_EQ(connected_parts(build_world(make_building(seed, {kinds, {}})).route), 1);
    }
  }
}

TEST(Building, SizesAreAsAsked) {
  for (const Kinds& kinds : every_kind()) {
    for (const Vector3d& size : {Vector3d(32, 12, 4.6), Vector3d(60, 33, 5.1)}) {
      SCOPED_TRACE(names_of(kinds));
      const World world = build_world(make_building(5, {kinds, size}));
      const WorldExtent box = extent(world);
      EXPECT_GE(box.low_m.minCoeff(), -1e-9);
      EXPECT_LE((box.high_m - size).maxCoeff(), 0.0021);  // parts are rounded to 0.1 mm
      EXPECT_GT(box.high_m.x(), size.x() - 3);
    }
  }
}

TEST(Building, SmallestSizes) {
  const std::vector<std::pair<BuildingKind, Vector3d>> smallest{
      {BuildingKind::home, {3, 3, 2.3}},
      {BuildingKind::hall, {8, 8, 4.5}},
      {BuildingKind::corridors, {4, 4, 2.3}}};
  for (const auto& [kind, size] : smallest) {
    SCOPED_TRACE(name_of(kind));
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const World world = build_world(make_building(seed, {{kind}, size}));
      EXPECT_FALSE(world.route.empty());
      expect_clear_route(world);
    }
  }
}

TEST(Building, RefusesWhatDoesNotFit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Kinds& kinds : every_kind()) {
    SCOPED_TRACE(names_of(kinds));
    EXPECT_THROW(make_building(1, {kinds, Vector3d(2, 2, 2.5)}), Error);
    EXPECT_THROW(make_building(1, {kinds, Vector3d(20, 15, 2)}), Error);
    EXPECT_THROW(make_building(1, {kinds, Vector3d(20, nan, 5)}), Error);
    EXPECT_THROW(make_building(1, {kinds, Vector3d(1e5, 15, 5)}), Error);
  }
  EXPECT_THROW(make_building(1, {{}, {}}), Error);
}

// A wall that ended too early, or a missing reveal, would let the eye out: a ray to far outside
// meets a surface whatever its direction.
TEST(Building, NobodySeesOut) {
  for (const Kinds& kinds : every_kind()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(names_of(kinds) + " " + std::to_string(seed));
      const World world = build_world(make_building(seed, {kinds, {}}));
      const Visibility visibility(world);
      int seen_out = 0;
      const double length = route_length_m(world.route);
      for (int i = 0; i < 40; ++i) {
        const RoutePoint at = route_point(world.route, length * (i + 0.5) / 40);
        const Vector3d eye(at.pose.x_m, at.pose.y_m, 1.1);
        for (int k = 0; k < 60; ++k) {
          const double turn = 0.1 + 6.283 * k / 60, rise = 0.9 * ((k * 7) % 60 - 30) / 30.0;
          const Vector3d ray(std::cos(turn), std::sin(turn), rise);
          seen_out += visibility.sees(eye, eye + 1000 * ray);
        }
      }
      EXPECT_EQ(seen_out, 0);
    }
  }
}

}  // namespace
}  // namespace vernier
