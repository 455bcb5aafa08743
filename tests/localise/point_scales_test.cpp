// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/join/point_scales.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "localise/joined_lines.h"
#include "tests/support/line_scenes.h"

namespace vernier::localise::internal {
namespace {

/// Views of a room from a ring, 1.5 to 4.5 m from its lines; points divided by 1 + `depth` and
/// 1 + `depth` + `across`.
std::vector<SegmentsOfView> views_of(std::uint32_t trial, double depth, double across) {
  std::vector<SegmentsOfView> views =
      test::scene_of(test::random_lines(60, trial), 24, trial, {}, 0.6).views;
  for (SegmentsOfView& view : views) {
    for (SightedSegment& s : view.segments) {
      for (Eigen::Vector3d* p : {&s.a_m, &s.b_m}) {
        p->z() /= 1 + depth;
        p->head<2>() /= 1 + depth + across;
      }
    }
  }
  return views;
}

// |x| < 4.5 σ of every scale in 40 trials: a false alarm in 1 of 1,800 seeds, and 2 for the scatter
// of a sandwich of 24 views.
TEST(PointScales, AreNothingWhereAllIsRight) {
  double depth2 = 0, across2 = 0;
  constexpr int trials = 40;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const auto views = views_of(trial, 0, 0);
    const auto found = point_scales(views, join_lines(views), {});
    ASSERT_TRUE(found);
    EXPECT_LT(std::abs(found->depth), 4.5 * found->depth_sigma);
    EXPECT_LT(std::abs(found->across), 4.5 * found->across_sigma);
    depth2 += std::pow(found->depth / found->depth_sigma, 2) / trials;
    across2 += std::pow(found->across / found->across_sigma, 2) / trials;
  }
  EXPECT_GT(depth2, 0.4);
  EXPECT_LT(depth2, 2.2);
  EXPECT_GT(across2, 0.4);
  EXPECT_LT(across2, 2.2);
}

TEST(PointScales, AreFoundByJoiningAgain) {
  for (const double depth : {-0.03, 0.0, 0.02}) {
    for (const double across : {-0.02, 0.0, 0.03}) {
      const auto views = views_of(7, depth, across);
      const auto first = point_scales(views, join_lines(views), {});
      ASSERT_TRUE(first);
      const PointScales found = joined_point_scales(views, *first, {});
      EXPECT_NEAR(found.depth, depth, 0.004) << depth << ' ' << across << ' ' << first->depth;
      EXPECT_NEAR(found.across, across, 0.004) << depth << ' ' << across << ' ' << first->across;
    }
  }
}

TEST(PointScales, NeedManyViewsThatSeeOneAnothersLines) {
  std::vector<SegmentsOfView> views = views_of(3, 0, 0);
  views.resize(8);
  EXPECT_FALSE(point_scales(views, join_lines(views), {}));
  EXPECT_FALSE(point_scales({}, {}, {}));
}

}  // namespace
}  // namespace vernier::localise::internal
