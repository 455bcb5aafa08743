// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/stretch_correlation.h"
#include "tests/support/error_message.h"
#include "tests/support/leaf_pair.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

/// Shares of the edges that are well inside the right image: matched, and more than 3 px wrong.
std::pair<double, double> density_and_mismatch(const test::LeafPlane& plane, std::uint64_t seed) {
  const RectifiedPair pair = test::leaf_pair(plane, seed);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const auto found = stretch_matcher().match(pair, edges, {0, 60});
  int asked = 0, matched = 0, wrong = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double x = edges[i].row_x_px, truth = plane.disparity_at(x, edges[i].y);
    if (std::abs(edges[i].normal.x()) < 0.0872f || truth < 0 || x - truth < 20) continue;
    ++asked;
    if (!found[i].matched()) continue;
    ++matched;
    wrong += std::abs(found[i].disparity_px - truth) > 3;
  }
  return {static_cast<double>(matched) / asked, static_cast<double>(wrong) / matched};
}

TEST(StretchMatcher, FindsPlanesThatFaceTheCamerasAndSlant) {
  for (const double by_x : {0.0, 0.15, -0.15}) {
    const auto [density, mismatch] = density_and_mismatch({.disparity_px = 28, .by_x = by_x}, 241);
    EXPECT_GT(density, 0.8) << by_x;
    EXPECT_LT(mismatch, 0.02) << by_x;
  }
}

TEST(StretchMatcher, SaysTheSameTwice) {
  const RectifiedPair pair = test::leaf_pair({}, 242);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const auto one = stretch_matcher().match(pair, edges, {0, 40});
  const auto two = stretch_matcher().match(pair, edges, {0, 40});
  ASSERT_EQ(one.size(), edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(one[i].disparity_px),
              std::bit_cast<std::uint32_t>(two[i].disparity_px));
  }
}

TEST(StretchMatcher, NamesWhatItCannotTake) {
  RectifiedPair pair = test::leaf_pair({.width_px = 80, .height_px = 60}, 243);
  pair.right = test::leaf_pair({.width_px = 80, .height_px = 50}, 243).right;
  EXPECT_NE(test::error_message([&] {
              stretch_matcher().match(pair, {}, {0, 20});
            }).find("80x60"),
            std::string::npos);
  pair.right = pair.left;
  EXPECT_NE(test::error_message([&] {
              stretch_matcher().match(pair, {}, {0, 80});
            }).find("width"),
            std::string::npos);
  EXPECT_TRUE(stretch_matcher().match(pair, {}, {0, 20}).empty());
}

}  // namespace
}  // namespace vernier
