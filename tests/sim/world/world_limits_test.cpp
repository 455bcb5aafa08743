// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "sim/world.h"
#include "sim/world_file.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

using Eigen::Vector3d;

const std::string world_head = "format = \"vernier/world\"\nversion = 1\n";
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string fault_of(const WorldDescription& world) {
  return test::error_message([&] { build_world(world); });
}

std::string fault_of_text(const std::string& text) {
  return test::error_message([&] { parse_world(world_head + text, "w.toml"); });
}

WorldDescription one_segment() {
  WorldDescription world;
  world.loose.segments_m = {{{0, 0, 0}, {1, 0, 0}}};
  return world;
}

TEST(WorldLimits, EveryKindOfPointBeyondTheLargestCoordinateIsRefused) {
  for (const double far : {1.01e4, -1.01e4, 1e6, 1e308}) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d point = far * Vector3d::Unit(axis);
      WorldDescription segment, corner, surface, instance, turned;
      segment.loose.segments_m = {{{0, 0, 0}, point}};
      corner.loose.corners_m = {point};
      surface.loose.surfaces_m = {{{0, 0, 0}, {1, 1, 1}, point}};
      instance = one_segment();
      instance.templates = {{"t", {}}};
      instance.instances = {{"t", point, 0}};
      for (const WorldDescription* world : {&segment, &corner, &surface, &instance}) {
        EXPECT_NE(fault_of(*world).find("is farther than 10000 m from the origin"),
                  std::string::npos)
            << fault_of(*world);
      }
    }
    WorldDescription route = one_segment();
    route.route = {{{{0, 0}, {far, 0}}}};
    EXPECT_NE(fault_of(route).find("route 0: is farther than 10000 m"), std::string::npos);
  }
}

TEST(WorldLimits, AnInstanceLiesInsideWithAllOfItsTemplate) {
  WorldDescription world;
  world.templates = {{"long", {}}};
  world.templates[0].features.segments_m = {{{0, 0, 0}, {8000, 0, 0}}};
  world.instances = {{"long", {0, 0, 0}, 0.3}};
  EXPECT_EQ(fault_of(world), "");
  world.instances[0].at_m.y() = 3000;
  EXPECT_NE(fault_of(world).find("instance 0: is farther than"), std::string::npos);
}

TEST(WorldLimits, TheLargestCoordinateItselfIsAccepted) {
  WorldDescription world;
  world.loose.segments_m = {{{-1e4, -1e4, -1e4}, {1e4, 1e4, 1e4}}};
  EXPECT_EQ(fault_of(world), "");
}

TEST(WorldLimits, FilesAreRefusedWithTheLine) {
  EXPECT_EQ(fault_of_text("[loose]\nsegments = [[0,0,0,1,0,0],\n[0,0,0,1e6,0,0]]\n"),
            "w.toml:5: loose segment 1 is farther than 10000 m from the origin along an axis; give "
            "metres, from an origin near the world");
  EXPECT_EQ(fault_of_text("[loose]\ncorners = [[0,0,1e308]]\n").substr(0, 30),
            "w.toml:4: loose corner 0 is fa");
  EXPECT_EQ(fault_of_text("[[template]]\nname = \"t\"\n[[instance]]\ntemplate = \"t\"\n"
                          "at_m = [1e5, 0, 0]\n")
                .substr(0, 27),
            "w.toml:5: instance 0 is far");
  EXPECT_EQ(fault_of_text("[[route]]\npoints_m = [[0,0],[1e9,0]]\n").substr(0, 30),
            "w.toml:4: route 0 is farther t");
}

TEST(WorldLimits, FeaturesAreCountedBeforeTemplatesAreInstantiated) {
  WorldDescription world;
  world.templates = {{"t", {}}};
  for (int i = 0; i < 1000; ++i) {
    world.templates[0].features.segments_m.push_back({{0, 0, 0.01 * i}, {1, 0, 0}});
  }
  world.instances.assign(1001, {"t", {0, 0, 0}, 0});
  EXPECT_EQ(
      fault_of(world),
      "world: has 1001000 segments, more than 1000000; split the world, or leave out details");
  world.instances.assign(most_features + 1, {"t", {0, 0, 0}, 0});
  world.templates[0].features = {};
  EXPECT_NE(fault_of(world).find("has 1000001 objects"), std::string::npos);
}

TEST(WorldLimits, ASurfaceHasFewPoints) {
  WorldDescription world = one_segment();
  std::vector<Vector3d> disc(most_polygon_points);
  const auto draw = [&] {
    for (std::size_t i = 0; i < disc.size(); ++i) {
      const double turn =
          2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(disc.size());
      disc[i] = {std::cos(turn), std::sin(turn), 1};
    }
    world.loose.surfaces_m = {disc};
  };
  draw();
  EXPECT_EQ(fault_of(world), "");
  disc.emplace_back();
  draw();
  EXPECT_NE(fault_of(world).find("loose surface 0: has 201 points, more than 200"),
            std::string::npos);
}

TEST(WorldLimits, RoutesAreNeitherTooLongNorTooFine) {
  WorldDescription world = one_segment();
  world.route = {{{{0, 0}}}};
  for (int i = 0; i < 11; ++i) world.route[0].points_m.push_back({i % 2 ? 0 : 1e4, 0});
  EXPECT_NE(fault_of(world).find("has a route of 110000 m, longer than 100000 m"),
            std::string::npos);
  world.route[0].points_m.assign(most_route_points + 1, {0, 0});
  EXPECT_NE(fault_of(world).find("has a route of 100001 points, more than 100000"),
            std::string::npos);
}

TEST(WorldLimits, AMapHasAtMostSoManyViewsAndNeverSilentlyOneALeg) {
  const std::vector<RouteLeg> long_leg{{{{0, 0}, {1e9, 0}}}};
  for (const double spacing_m : {0.5, 1e-3, 1e-300, 5e-324}) {
    EXPECT_NE(test::error_message([&] { map_poses(long_leg, spacing_m); }).find("more than 100000"),
              std::string::npos)
        << spacing_m;
  }
  for (const double spacing_m : {0.0, -1.0, nan}) {
    EXPECT_NE(test::error_message([&] { map_poses(long_leg, spacing_m); }).find("not above 0"),
              std::string::npos);
  }
  const std::vector<RouteLeg> endless{{{{0, 0}, {nan, 0}}}};
  EXPECT_NE(test::error_message([&] { map_poses(endless, 1); }), "");
  const std::vector<RouteLeg> leg{{{{0, 0}, {1000, 0}}}};
  EXPECT_EQ(map_poses(leg, 0.01).size(), 100'000u);
  EXPECT_NE(test::error_message([&] { map_poses(leg, 0.01, 2); }).find("gives 200000 views"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
