// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/range_probe.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "stereo/grey_levels.h"
#include "tests/support/grey_levels.h"
#include "tests/support/leaf_pair.h"

namespace vernier::stereo::internal {
namespace {

/// Leaves at one disparity in the left half of the left image, at a larger one in the right half.
RectifiedPair two_depths(double far_px, double near_px, std::uint64_t seed) {
  const RectifiedPair far = test::leaf_pair({.disparity_px = far_px}, seed),
                      near = test::leaf_pair({.disparity_px = near_px}, seed + 1000);
  RectifiedPair pair = far;
  const int width = far.left.width_px;
  for (int y = 0; y < far.left.height_px; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(x);
      if (2 * x >= width) pair.left.values[at] = near.left.values[at];
      if (2 * (x + near_px) >= width) pair.right.values[at] = near.right.values[at];
    }
  }
  return pair;
}

TEST(RangeProbe, OfARangeThatHoldsTheSceneFindsNothing) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const OutsideRange outside = outside_range(two_depths(6, 24, seed), {0, 40});
    EXPECT_GT(outside.matched, 500);
    EXPECT_LT(outside.below + outside.above, 0.005 * outside.matched) << seed;
    EXPECT_EQ(outside.wider.min_px, 0);
    EXPECT_EQ(outside.wider.max_px, 40);
  }
}

TEST(RangeProbe, FindsWhatLiesBelow) {
  for (const double far_px : {-5.0, -12.0}) {
    const OutsideRange outside = outside_range(two_depths(far_px, 24, 11), {0, 40});
    EXPECT_GT(outside.below, 0.3 * outside.matched) << far_px;
    EXPECT_LT(outside.below, 0.7 * outside.matched) << far_px;
    EXPECT_LT(outside.above, 0.005 * outside.matched) << far_px;
    EXPECT_LE(outside.wider.min_px, far_px);
    EXPECT_GE(outside.wider.min_px, far_px - 10);
  }
}

TEST(RangeProbe, FindsWhatLiesAbove) {
  const OutsideRange outside = outside_range(two_depths(6, 40, 21), {0, 30});
  EXPECT_GT(outside.above, 0.3 * outside.matched);
  EXPECT_LT(outside.above, 0.7 * outside.matched);
  EXPECT_LT(outside.below, 0.005 * outside.matched);
  EXPECT_GE(outside.wider.max_px, 40);
  EXPECT_LE(outside.wider.max_px, 50);
}

TEST(RangeProbe, SaysNothingOfTinyImages) {
  const GreyLevels image = test::random_image(60, 60, 1);
  const OutsideRange outside = outside_range({image, image}, {0, 16});
  EXPECT_EQ(outside.matched, 0);
  EXPECT_EQ(outside.below + outside.above, 0);
}

TEST(RangeProbe, StaysWithinTheWidth) {
  const OutsideRange outside = outside_range(two_depths(6, 24, 31), {0, 319});
  EXPECT_GT(outside.matched, 500);
  EXPECT_EQ(outside.above, 0);
}

TEST(RangeProbe, LeavesOutPixelsWithoutASource) {
  const RectifiedPair pair = two_depths(-12, 24, 41);
  const HasSource near_half = [&](int x, int) { return 2 * x > pair.left.width_px; };
  const OutsideRange all = outside_range(pair, {0, 40}),
                     left = outside_range(pair, {0, 40}, near_half),
                     right = outside_range(pair, {0, 40}, {}, near_half);
  EXPECT_LT(left.edges, 0.6 * all.edges);
  EXPECT_LT(left.below, 0.01 * left.matched);
  EXPECT_LT(right.below, 0.2 * all.below);  // of the far half, what is seen beyond the middle
}

}  // namespace
}  // namespace vernier::stereo::internal
