// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/buildings/space.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "sim/buildings/building_site.h"
#include "sim/buildings/wire_shapes.h"

namespace vernier {

using namespace vernier::sim::internal;

namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Twice the area that closed walls go around, with what they enclose taken off (Gauss's formula).
double enclosed_m2(const std::vector<RoomWall>& walls) {
  double twice = 0;
  for (const RoomWall& wall : walls) {
    const Vector3d a = wall.frame.origin_m, b = wall.frame * Vector3d(wall.length_m, 0, 0);
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

double area_by_counting_m2(const std::vector<AlignedBox2d>& floor) {
  constexpr double step = 0.05;
  int inside = 0;
  for (double x = step / 2; x < 12; x += step) {
    for (double y = step / 2; y < 12; y += step) {
      inside += std::any_of(floor.begin(), floor.end(),
                            [&](const auto& part) { return part.contains(Vector2d(x, y)); });
    }
  }
  return inside * step * step;
}

TEST(Space, WallsGoAroundARoom) {
  const auto walls = walls_around({{Vector2d(1, 2), Vector2d(5, 4)}});
  ASSERT_EQ(walls.size(), 4u);
  EXPECT_NEAR(enclosed_m2(walls), 8, 1e-12);
}

TEST(Space, WallsGoAroundCrossingCorridorsAndWhatTheyEnclose) {
  // Two corridors each way enclose a block, and three of their ends are dead.
  const std::vector<AlignedBox2d> floor{{Vector2d(0, 1), Vector2d(10, 3)},
                                        {Vector2d(2, 7), Vector2d(10, 9)},
                                        {Vector2d(2, 1), Vector2d(4, 9)},
                                        {Vector2d(7, 0), Vector2d(9, 11)}};
  const auto walls = walls_around(floor);
  EXPECT_NEAR(enclosed_m2(walls), area_by_counting_m2(floor), 1e-9);
  double length = 0;
  for (const RoomWall& wall : walls) {
    length += wall.length_m;
    // The floor lies on the side to which y of the wall's frame points, and not on the other.
    const Vector3d in = wall.frame * Vector3d(wall.length_m / 2, 0.01, 0);
    const Vector3d out = wall.frame * Vector3d(wall.length_m / 2, -0.01, 0);
    const auto holds = [&](const Vector3d& x) {
      return std::any_of(floor.begin(), floor.end(),
                         [&](const auto& part) { return part.contains(Vector2d(x.head<2>())); });
    };
    EXPECT_TRUE(holds(in));
    EXPECT_FALSE(holds(out));
  }
  // Counted by hand: 44 m outside, 14 m around the block.
  EXPECT_NEAR(length, 58, 1e-9);
}

TEST(Space, FacesOfAWallLeaveItsOpeningsFree) {
  const std::vector<AlignedBox2d> floor{{Vector2d(0, 0), Vector2d(6, 4)}};
  const auto walls = walls_around(floor);
  const std::vector<Opening> openings{{0, 4.5}, {0, 1.5, 1.0, 2.2, 0}};
  Shapes shapes;
  raise_room(shapes, floor, walls, 2.5, openings);
  double area = 0;
  for (const auto& polygon : shapes.features().surfaces_m) {
    area += (polygon[1] - polygon[0]).cross(polygon[3] - polygon[0]).norm();
  }
  EXPECT_NEAR(area, 2 * 24 + 20 * 2.5 - 0.9 * 2.05 - 1.0 * 2.2, 1e-9);
}

}  // namespace
}  // namespace vernier
