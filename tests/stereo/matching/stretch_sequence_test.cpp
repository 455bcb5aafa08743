// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/stretch_correlation.h"
#include "tests/support/error_message.h"
#include "tests/support/leaf_pair.h"
#include "tests/support/plane_figures.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

long searched(const StretchFrame& frame) {
  long sum = 0;
  for (const StretchBlock& block : frame.blocks.blocks) sum += block.searched;
  return sum;
}

/// A plane that comes nearer by a pixel and a half a frame.
class StretchSequence : public testing::Test {
 protected:
  StretchSequence() { options.halvings = 0; }

  static constexpr DisparityRange range{0, 80};
  static test::LeafPlane plane(int frame) {
    return {.disparity_px = 20 + 1.5 * frame, .by_x = 0.05};
  }
  struct View {
    explicit View(int frame)
        : pair(test::leaf_pair(plane(frame), 312)), edges(canny_edges(pair.left)) {}
    RectifiedPair pair;
    std::vector<EdgePoint> edges;
  };
  StretchFrame match(const View& view, const StretchFrame* last = nullptr) const {
    return match_by_stretch(view.pair, view.edges, range, options, last);
  }

  StretchOptions options;
};

TEST_F(StretchSequence, FollowsAPlaneWithFewerSearches) {
  StretchFrame last;
  for (int k = 0; k < 5; ++k) {
    const View view(k);
    StretchFrame now = match(view, k == 0 ? nullptr : &last);
    const StretchFrame alone = match(view);
    const test::PlaneFigures f = test::figures(plane(k), view.edges, now.at_edges);
    EXPECT_EQ(now.number, static_cast<std::uint32_t>(k));
    EXPECT_GT(f.density, figures(plane(k), view.edges, alone.at_edges).density - 0.02);
    EXPECT_LT(f.mismatch, 0.01);
    if (k > 0) {
      EXPECT_LT(searched(now), searched(alone) / 3);
    }
    last = std::move(now);
  }
}

TEST_F(StretchSequence, SomeBlocksSearchEverywhere) {
  const View view(0);
  const StretchFrame first = match(view);
  const auto everywhere = [&](double share, const StretchFrame& last) {
    options.full_search_share = share;
    const StretchFrame next = match(view, &last);
    std::vector<bool> full;
    for (std::size_t k = 0; k < next.blocks.blocks.size(); ++k) {
      const int own = next.blocks.blocks[k].searched;
      full.push_back(own > 0 && own == first.blocks.blocks[k].searched);
    }
    return full;
  };
  const auto count = [](const std::vector<bool>& v) {
    return static_cast<double>(std::count(v.begin(), v.end(), true));
  };
  const std::vector<bool> none = everywhere(0, first), tenth = everywhere(0.1, first);
  const double rest = count(everywhere(1, first)) - count(none);
  // Within five standard deviations of a binomial: false alarm below 1e-6.
  EXPECT_NEAR(count(tenth) - count(none), 0.1 * rest, 5 * std::sqrt(0.09 * rest));
  EXPECT_EQ(everywhere(0.1, first), tenth);
  StretchFrame later = first;
  later.number = 7;
  EXPECT_NE(everywhere(0.1, later), tenth);  // other blocks in another frame
}

TEST_F(StretchSequence, RecoversFromAWrongPast) {
  const View view(0);
  StretchFrame frame = match(view);
  for (StretchBlock& block : frame.blocks.blocks) block.disparity_px = 60;
  for (int k = 0; k < 3; ++k) frame = match(view, &frame);
  const test::PlaneFigures f = test::figures(plane(0), view.edges, frame.at_edges);
  EXPECT_GT(f.density, 0.85);
  EXPECT_LT(f.mismatch, 0.01);
}

TEST_F(StretchSequence, RefusesAnotherSize) {
  const StretchFrame last = match(View(0));
  const RectifiedPair small = test::leaf_pair({.width_px = 100, .height_px = 60}, 313);
  EXPECT_NE(test::error_message([&] {
              match_by_stretch(small, {}, {0, 40}, {}, &last);
            }).find("another image size"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
