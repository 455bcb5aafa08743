// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/floor_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "sim/study/floor_rows.h"

namespace vernier {

using namespace vernier::sim::internal;

namespace {

using Eigen::Vector2d;

/// Points around (x, y), and a grid of them.
struct PointsOnFloor {
  PointsOnFloor(double x, double y, double cell_m) : grid(cell_m) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> about(-20, 20);
    for (int i = 0; i < 2000; ++i) {
      points.push_back({x + about(random), y + about(random)});
      grid.add(points.back(), i);
    }
  }

  std::vector<Vector2d> points;
  FloorGrid grid;
};

TEST(FloorRows, FindTheVeryPointsOfARing) {
  for (const double row_m : {0.1, 1.0, 7.0}) {
    const PointsOnFloor floor(-9980, 9975, 1);
    const FloorRows rows(floor.points, row_m);
    for (const double outer : {0.05, 0.5, 3.0, 15.0, 60.0}) {
      for (const double inner : {0.0, 0.3 * outer, 0.98 * outer}) {
        const Vector2d& at = floor.points[7];
        std::vector<int> found, expected;
        rows.visit_ring(at, inner, outer, [&](int i) { found.push_back(i); });
        std::sort(found.begin(), found.end());
        for (int i = 0; i < 2000; ++i) {
          const double d2 = (floor.points[i] - at).squaredNorm();
          if (d2 >= inner * inner && d2 <= outer * outer) expected.push_back(i);
        }
        EXPECT_EQ(found, expected) << inner << " to " << outer;
      }
    }
  }
}

TEST(FloorGrid, FindsEveryPointNear) {
  const PointsOnFloor floor(0, 0, 0.5);
  for (int k = 0; k < 100; ++k) {
    std::vector<int> found;
    floor.grid.any_near(floor.points[k], 1.2, [&](int i) {
      found.push_back(i);
      return false;
    });
    for (int i = 0; i < 2000; ++i) {
      if ((floor.points[i] - floor.points[k]).norm() > 1.2) continue;
      EXPECT_NE(std::find(found.begin(), found.end(), i), found.end());
    }
  }
}

}  // namespace
}  // namespace vernier
