// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/world.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "calib/error.h"

namespace vernier {

using namespace vernier::sim;

namespace {

using Eigen::Vector3d;

WorldDescription one_door() {
  WorldDescription world;
  WorldTemplate door{"door", {}};
  door.features.segments_m = {{{0, 0, 0}, {0, 0, 2}}, {{0, 0, 2}, {0.9, 0, 2}}};
  door.features.corners_m = {{0, 0, 2}};
  door.features.surfaces_m = {{{0, 0, 0}, {0.9, 0, 0}, {0.9, 0, 2}, {0, 0, 2}}};
  world.templates = {door};
  world.instances = {{"door", {1, 2, 0}, std::numbers::pi / 2}};
  world.loose.segments_m = {{{0, 0, 0}, {4, 0, 0}}};
  return world;
}

std::string message_of(const WorldDescription& world) {
  try {
    build_world(world);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(World, PlacesInstancesAfterLooseFeatures) {
  const World world = build_world(one_door());
  ASSERT_EQ(world.segments.size(), 3u);
  ASSERT_EQ(world.objects.size(), 2u);
  EXPECT_EQ(world.objects[0].template_name, "");
  EXPECT_EQ(world.objects[1].template_name, "door");
  EXPECT_EQ(world.segments[0].object, 0);
  EXPECT_EQ(world.segments[2].object, 1);
  EXPECT_EQ(world.corners[0].object, 1);
  EXPECT_EQ(world.surfaces[0].object, 1);
}

TEST(World, QuarterTurnsAreExact) {
  const World world = build_world(one_door());
  EXPECT_EQ(world.segments[2].a_m, Vector3d(1, 2, 2));
  EXPECT_EQ(world.segments[2].b_m, Vector3d(1, 2.9, 2));
  EXPECT_EQ(world.surfaces[0].polygon_m[2], Vector3d(1, 2.9, 2));
}

TEST(World, OtherAnglesTurnCounterClockwise) {
  WorldDescription description = one_door();
  description.instances[0].yaw_rad = std::numbers::pi / 6;
  const World world = build_world(description);
  const Vector3d expected(1 + 0.9 * std::cos(std::numbers::pi / 6), 2.45, 2);
  EXPECT_LT((world.segments[2].b_m - expected).norm(), 1e-12);
}

TEST(World, RepeatedShareCountsTemplatesPlacedTwice) {
  WorldDescription description = one_door();
  EXPECT_EQ(repeated_share(build_world(description)), 0);
  description.instances.push_back({"door", {5, 5, 0}, 0});
  EXPECT_DOUBLE_EQ(repeated_share(build_world(description)), 0.8);
  EXPECT_EQ(repeated_share(World{}), 0);
}

TEST(World, ExtentBoundsAllSegments) {
  const WorldExtent box = extent(build_world(one_door()));
  EXPECT_EQ(box.low_m, Vector3d(0, 0, 0));
  EXPECT_EQ(box.high_m, Vector3d(4, 2.9, 2));
}

TEST(World, RefusesAnUnknownTemplate) {
  WorldDescription world = one_door();
  world.instances.push_back({"dor", {0, 0, 0}, 0});
  EXPECT_EQ(message_of(world), "instance 1: unknown template 'dor'; define it or use another");
}

TEST(World, RefusesTwoTemplatesOfOneName) {
  WorldDescription world = one_door();
  world.templates.push_back(world.templates[0]);
  EXPECT_EQ(message_of(world), "template 1: duplicate name 'door'; rename one of the two");
}

TEST(World, RefusesAShortSegment) {
  WorldDescription world = one_door();
  world.templates[0].features.segments_m[1] = {{0, 0, 2}, {0.0009, 0, 2}};
  EXPECT_EQ(message_of(world),
            "template 'door' segment 1: is shorter than 1 mm; move one end or remove it");
  world.templates[0].features.segments_m[1] = {{0, 0, 2}, {0.001, 0, 2}};
  EXPECT_EQ(message_of(world), "");
}

TEST(World, RefusesBadSurfaces) {
  WorldDescription world = one_door();
  auto& polygon = world.templates[0].features.surfaces_m[0];
  polygon[2].y() = 0.01;
  EXPECT_EQ(message_of(world),
            "template 'door' surface 0: is not planar to 1 mm; split it into triangles");
  polygon[2].y() = 0.0005;
  EXPECT_EQ(message_of(world), "");
  polygon = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_NE(message_of(world).find("has no area"), std::string::npos);
  polygon = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_NE(message_of(world).find("fewer than three points"), std::string::npos);
}

TEST(World, AcceptsASurfaceThatIsNotConvex) {
  WorldDescription world;
  world.loose.surfaces_m = {
      {{0, 0, 0}, {3, 0, 0}, {3, 0, 2}, {2, 0, 2}, {2, 0, 1}, {1, 0, 1}, {1, 0, 2}, {0, 0, 2}}};
  EXPECT_EQ(build_world(world).surfaces.size(), 1u);
}

TEST(World, RefusesNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  WorldDescription world = one_door();
  world.loose.segments_m[0].second.x() = nan;
  EXPECT_EQ(message_of(world), "loose segment 0: is not finite; use six finite numbers");
  world = one_door();
  world.loose.corners_m = {{0, nan, 0}};
  EXPECT_NE(message_of(world).find("loose corner 0"), std::string::npos);
  world = one_door();
  world.instances[0].yaw_rad = nan;
  EXPECT_NE(message_of(world).find("instance 0"), std::string::npos);
  world = one_door();
  world.route = {{{{0, 0}}}};
  EXPECT_NE(message_of(world).find("route 0: has fewer than two points"), std::string::npos);
}

}  // namespace
}  // namespace vernier
