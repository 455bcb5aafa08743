// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/office.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "calib/error.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "tests/support/clear_route.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::sim::internal;
using test::expect_clear_route;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Grid = std::array<long, 3>;

Grid grid(const Vector3d& x) {
  return {std::lround(x.x() * 1e4), std::lround(x.y() * 1e4), std::lround(x.z() * 1e4)};
}

const World& workshop() {
  static const World world = build_world(make_office(1));
  return world;
}

// Exactly the same two ends, whichever comes first; across all objects.
int coincident_segments(const World& world) {
  std::set<std::array<Grid, 2>> seen;
  int twice = 0;
  for (const auto& segment : world.segments) {
    std::array<Grid, 2> key{grid(segment.a_m), grid(segment.b_m)};
    std::sort(key.begin(), key.end());
    twice += seen.insert(key).second ? 0 : 1;
  }
  return twice;
}

TEST(Office, WorkshopHasTheSizeOfTheMemo) {
  const WorldExtent box = extent(workshop());
  EXPECT_EQ(box.low_m, Vector3d(0, 0, 0));
  EXPECT_EQ(box.high_m, Vector3d(20, 15, 2.5));
  EXPECT_GE(workshop().segments.size(), 7500u);
  EXPECT_LE(workshop().segments.size(), 12000u);
  EXPECT_GE(workshop().corners.size(), 4000u);
  EXPECT_LT(format_world(make_office(1)).size(), 700000u);
}

TEST(Office, MostSegmentsAreOfRepeatedTemplates) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const double share = repeated_share(build_world(make_office(seed)));
    EXPECT_GT(share, 0.5);
    EXPECT_LT(share, 0.7);
  }
}

TEST(Office, SameSeedGivesTheSameText) {
  EXPECT_EQ(format_world(make_office(7)), format_world(make_office(7)));
  EXPECT_NE(format_world(make_office(7)), format_world(make_office(8)));
}

TEST(Office, TextSaysTheSameToTheBit) {
  const WorldDescription made = make_office(1);
  const std::string text = format_world(made);
  const WorldDescription read = parse_world(text, "text");
  EXPECT_EQ(format_world(read), text);
  const World a = build_world(made), b = build_world(read);
  ASSERT_EQ(a.segments.size(), b.segments.size());
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    ASSERT_EQ(a.segments[i].a_m, b.segments[i].a_m);
    ASSERT_EQ(a.segments[i].b_m, b.segments[i].b_m);
  }
  ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
    ASSERT_EQ(a.surfaces[i].polygon_m, b.surfaces[i].polygon_m);
  }
}

TEST(Office, RouteKeepsClearOfEverything) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    expect_clear_route(build_world(make_office(seed)));
  }
}

TEST(Office, RouteVisitsTheCorridorAndEveryRoom) {
  const auto& route = workshop().route;
  ASSERT_EQ(route.size(), 11u);
  EXPECT_EQ(route[0].points_m.front(), Vector2d(0.6, 7.5));
  EXPECT_EQ(route[0].points_m.back(), Vector2d(19.4, 7.5));
  double length = 0;
  for (const auto& leg : route) {
    for (std::size_t i = 1; i < leg.points_m.size(); ++i) {
      length += (leg.points_m[i] - leg.points_m[i - 1]).norm();
    }
  }
  EXPECT_GE(length, 75);
  EXPECT_LE(length, 95);
  for (std::size_t i = 1; i < route.size(); ++i) {
    EXPECT_EQ(route[i].points_m.front().y(), 7.5);
    EXPECT_EQ(route[i].points_m.size(), 4u);
  }
}

TEST(Office, NothingIsDrawnTwice) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    EXPECT_EQ(coincident_segments(build_world(make_office(seed))), 0);
  }
}

TEST(Office, CornersAreEndsOfTwoSegmentsAndUnique) {
  const WorldDescription office = make_office(1);
  std::vector<const FeatureSet*> sets{&office.loose};
  for (const auto& entry : office.templates) sets.push_back(&entry.features);
  for (const auto* features : sets) {
    std::map<Grid, int> ends;
    for (const auto& [a, b] : features->segments_m) {
      ++ends[grid(a)];
      ++ends[grid(b)];
    }
    std::set<Grid> seen;
    for (const auto& corner : features->corners_m) {
      EXPECT_GE(ends[grid(corner)], 2);
      EXPECT_TRUE(seen.insert(grid(corner)).second);
    }
  }
}

// What stands in a room, seen from the room's own corner: no two rooms may agree.
TEST(Office, RoomsDiffer) {
  const WorldDescription office = make_office(1);
  std::set<std::set<std::string>> rooms;
  for (int side = 0; side < 2; ++side) {
    for (int k = 0; k < 5; ++k) {
      std::set<std::string> things;
      for (const auto& instance : office.instances) {
        const double x = instance.at_m.x() - 4 * k;
        const double y = side ? 15 - instance.at_m.y() : instance.at_m.y();
        if (x < 0 || x > 4 || y > 6.5) continue;
        if (instance.template_name == "ceiling_light") continue;
        things.insert(instance.template_name + std::to_string(std::lround(10 * x)) + "," +
                      std::to_string(std::lround(10 * y)));
      }
      EXPECT_GT(things.size(), 10u);
      EXPECT_TRUE(rooms.insert(things).second);
    }
  }
}

TEST(Office, OtherSizesHoldTogether) {
  for (const Vector3d& size :
       {Vector3d(6, 8, 2.4), Vector3d(40, 12, 3), Vector3d(33.3, 25.7, 2.7)}) {
    const World world = build_world(make_office(5, {.size_m = size}));
    EXPECT_LT((extent(world).high_m - size).norm(), 1e-3);
    EXPECT_LT(extent(world).low_m.norm(), 1e-3);
    EXPECT_EQ(coincident_segments(world), 0);
    expect_clear_route(world);
  }
}

TEST(Office, RefusesSizesInWhichNoRoomFits) {
  EXPECT_THROW(make_office(1, {.size_m = {2, 15, 2.5}}), Error);
  EXPECT_THROW(make_office(1, {.size_m = {20, 5, 2.5}}), Error);
  EXPECT_THROW(make_office(1, {.size_m = {20, 15, 2}}), Error);
  EXPECT_THROW(make_office(1, {.size_m = {20, 15, std::nan("")}}), Error);
  EXPECT_THROW(make_office(1, {.size_m = {2000, 15, 2.5}}), Error);
  EXPECT_THROW(make_office(1, {.corridor_width_m = 0.5}), Error);
  EXPECT_THROW(make_office(1, {.room_width_m = 1}), Error);
}

}  // namespace
}  // namespace vernier
