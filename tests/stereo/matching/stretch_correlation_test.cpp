// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// The blocks of stretch correlation against the definition, sample by sample; edges of planes.
#include "stereo/matching/stretch_correlation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/stretch_filter.h"
#include "stereo/matching/stretch_search.h"
#include "tests/support/error_message.h"
#include "tests/support/grey_levels.h"
#include "tests/support/leaf_pair.h"
#include "tests/support/plane_figures.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

using test::leaf_pair;

/// The filtered value at a pixel, by its definition.
double filtered_at(const GreyLevels& image, const StretchOptions& options, int x, int y) {
  if (options.filter == StretchFilter::grey) return std::round(2 * (image(x, y) - 127.5));
  int rank = 0;
  const int reach = options.rank_reach_px;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      const float off = test::clamped(image, x + i, y + j) - image(x, y);
      rank += off < -options.rank_least_grey ? 1 : off > options.rank_least_grey ? -1 : 0;
    }
  }
  return rank;
}

/// ZNCC of blocks by the formula of the header, each sample on its own.
class Reference {
 public:
  Reference(const RectifiedPair& pair, const StretchOptions& options) : options_(options) {
    for (const bool is_left : {true, false}) {
      const GreyLevels& from = is_left ? pair.left : pair.right;
      GreyLevels& to = is_left ? left_ : right_;
      to = from;
      for (int y = 0; y < from.height_px; ++y) {
        for (int x = 0; x < from.width_px; ++x) {
          to.values[static_cast<std::size_t>(y * from.width_px + x)] =
              static_cast<float>(filtered_at(from, options, x, y));
        }
      }
    }
  }

  double score(const StretchBlock& block, int d, double stretch, double shear) const {
    double n = 0, l = 0, r = 0, ll = 0, rr = 0, lr = 0;
    for (int j = -options_.height_px / 2; j <= options_.height_px / 2; ++j) {
      for (int i = -options_.width_px / 2; i <= options_.width_px / 2; ++i) {
        const double left = test::clamped(left_, block.x + i, block.y + j);
        const double off = std::round(16 * (stretch * i + shear * j)) / 16;
        const int before = static_cast<int>(std::floor(off));
        const double t = off - before;
        const int x = block.x - d + before;
        const double right = (1 - t) * test::clamped(right_, x, block.y + j) +
                             t * test::clamped(right_, x + 1, block.y + j);
        n += 1, l += left, r += right;
        ll += left * left, rr += right * right, lr += left * right;
      }
    }
    return (lr - l * r / n) / std::sqrt((ll - l * l / n) * std::max(rr - r * r / n, 0.01 * n));
  }

 private:
  const StretchOptions& options_;
  GreyLevels left_, right_;
};

struct Case {
  StretchFilter filter;
  int shears;
  int width_px, height_px;  // of blocks
};

class BlocksByDefinition : public testing::TestWithParam<Case> {};

TEST_P(BlocksByDefinition, AreTheBestOfAllTried) {
  const RectifiedPair pair =
      leaf_pair({.width_px = 88, .height_px = 40, .disparity_px = 9, .by_x = 0.2}, 301);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  StretchOptions options;
  options.filter = GetParam().filter;
  options.shears = GetParam().shears;
  options.width_px = GetParam().width_px;
  options.height_px = GetParam().height_px;
  options.step_x_px = 11;
  options.halvings = 0;
  const DisparityRange range{-3, 20};
  const StretchBlocks found = stretch_blocks(pair, edges, range, options);
  const Reference reference(pair, options);
  const double half_step = 0.5001 * std::log(3.0) * 2 / (options.stretches - 1);
  int searched = 0;
  for (const StretchBlock& block : found.blocks) {
    if (block.fate == BlockStatus::few_edges) continue;
    ++searched;
    double best = -2, at_found = -2;
    for (const double stretch : stretches_of(options)) {
      for (const double shear : shears_of(options)) {
        for (int d = range.min_px; d <= range.max_px; ++d) {
          if (block.x - d < 0 || block.x - d >= pair.left.width_px) continue;
          const double score = reference.score(block, d, stretch, shear);
          best = std::max(best, score);
          // What is returned is at most half a step off the grid.
          const bool here = std::abs(block.disparity_px - static_cast<float>(d)) <= 0.5001f &&
                            block.shear == static_cast<float>(shear) &&
                            std::abs(std::log(block.stretch / stretch)) <= half_step;
          if (here) at_found = std::max(at_found, score);
        }
      }
    }
    EXPECT_NEAR(block.score, best, 1e-4) << block.x << " " << block.y;
    EXPECT_NEAR(at_found, best, 1e-4) << block.x << " " << block.y;
  }
  EXPECT_GT(searched, 30);
}

INSTANTIATE_TEST_SUITE_P(Filters,
                         BlocksByDefinition,
                         testing::Values(Case{StretchFilter::grey, 1, 17, 9},
                                         Case{StretchFilter::rank, 1, 17, 9},
                                         Case{StretchFilter::rank, 3, 17, 9},
                                         Case{StretchFilter::grey, 3, 9, 19},
                                         Case{StretchFilter::rank, 1, 33, 5}));

TEST(StretchFilters, CensusAndDerivativeByDefinition) {
  const GreyLevels image = leaf_pair({.width_px = 70, .height_px = 30}, 302).left;
  StretchOptions options;
  options.filter = StretchFilter::census;
  const FilteredImage census = filtered(image, options, 3, 2);
  options.filter = StretchFilter::derivative;
  const FilteredImage derivative = filtered(image, options, 3, 2);
  for (int y = -2; y < 32; ++y) {
    for (int x = -3; x < 73; ++x) {
      const int u = std::clamp(x, 0, 69), v = std::clamp(y, 0, 29);
      int plane = 0;
      for (const int j : {-2, 0, 2}) {
        for (const int i : {-2, 0, 2}) {
          if (i == 0 && j == 0) continue;
          const bool brighter = test::clamped(image, u + i, v + j) > image(u, v);
          ASSERT_EQ(census.row(plane++, y)[x], brighter ? 1 : -1) << x << " " << y;
        }
      }
      double sum = 0, weights = 0;
      for (int i = -3; i <= 3; ++i) {
        const double g = std::exp(-0.5 * i * i);
        sum += g * (test::clamped(image, u + i + 1, v) - test::clamped(image, u + i - 1, v));
        weights += g;
      }
      ASSERT_NEAR(derivative.row(0, y)[x], sum / weights, 0.501) << x << " " << y;
    }
  }
}

TEST(StretchCorrelation, BlocksAreKeptBySupport) {
  const RectifiedPair pair = leaf_pair({.disparity_px = 24, .by_x = 0.15}, 303);
  const StretchOptions options;
  const StretchBlocks grid = stretch_blocks(pair, canny_edges(pair.left), {0, 60}, options);
  const auto strong = [&](int column, int row) -> const StretchBlock* {
    if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) return nullptr;
    const StretchBlock& b = grid.blocks[static_cast<std::size_t>(row * grid.columns + column)];
    const bool good = b.edges >= options.min_edges && b.score >= float(options.min_score);
    return good ? &b : nullptr;
  };
  int kept = 0, lonely = 0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const StretchBlock& own = grid.blocks[static_cast<std::size_t>(row * grid.columns + column)];
      if (!strong(column, row)) {
        EXPECT_NE(own.fate, BlockStatus::kept);
        EXPECT_EQ(own.fate == BlockStatus::few_edges, own.edges < options.min_edges);
        continue;
      }
      int support = 0;
      for (int k = 0; k < 9; ++k) {
        const StretchBlock* other = strong(column + k % 3 - 1, row + k / 3 - 1);
        if (k == 4 || !other) continue;
        const double d = own.disparity_px - other->disparity_px;
        support += std::abs(d) <= std::hypot(own.x - other->x - 0.5 * d, own.y - other->y) ? 1 : 0;
      }
      EXPECT_EQ(own.support, support);
      EXPECT_EQ(own.fate, support >= 5 ? BlockStatus::kept : BlockStatus::lonely);
      (own.fate == BlockStatus::kept ? kept : lonely)++;
    }
  }
  EXPECT_GT(kept, 500);
  EXPECT_GT(lonely, 0);
}

test::PlaneFigures match_plane(const test::LeafPlane& plane,
                               int max_px,
                               const StretchOptions& options) {
  const RectifiedPair pair = leaf_pair(plane, 304);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  return test::figures(plane, edges, stretch_matcher(options).match(pair, edges, {0, max_px}));
}

TEST(StretchCorrelation, FollowsPlanes) {
  struct {
    double by_x, by_y, disparity_px;
    int max_px, shears;
    double density;
  } const planes[] = {
      {0, 0, 28, 60, 1, 0.9},     {0.15, 0, 28, 60, 1, 0.9},  {-0.15, 0, 28, 60, 1, 0.85},
      {0.3, 0, 60, 120, 1, 0.85}, {0.5, 0, 90, 180, 1, 0.7},  {-0.5, 0, 90, 180, 1, 0.85},
      {0, 0.2, 60, 120, 1, 0.85}, {0, 0.5, 70, 140, 3, 0.85},
  };
  for (const auto& p : planes) {
    StretchOptions options;
    options.shears = p.shears;
    const test::PlaneFigures f = match_plane(
        {.disparity_px = p.disparity_px, .by_x = p.by_x, .by_y = p.by_y}, p.max_px, options);
    EXPECT_GT(f.density, p.density) << p.by_x << " " << p.by_y;
    EXPECT_LT(f.mismatch, 0.01) << p.by_x << " " << p.by_y;
  }
}

TEST(StretchCorrelation, StretchIsThePlanes) {
  const RectifiedPair pair = leaf_pair({.disparity_px = 60, .by_x = 0.3}, 305);
  std::vector<float> stretches;
  for (const StretchBlock& b : stretch_blocks(pair, canny_edges(pair.left), {0, 120}).blocks) {
    if (b.fate == BlockStatus::kept) stretches.push_back(b.stretch);
  }
  ASSERT_GT(stretches.size(), 300U);
  std::sort(stretches.begin(), stretches.end());
  EXPECT_NEAR(stretches[stretches.size() / 2], 0.7, 0.04);
}

TEST(StretchCorrelation, EveryFilterFindsAPlane) {
  for (const StretchFilter filter : {StretchFilter::grey, StretchFilter::derivative,
                                     StretchFilter::rank, StretchFilter::census}) {
    StretchOptions options;
    options.filter = filter;
    if (filter == StretchFilter::census) options.min_score = 0.3;  // noise has signs too
    const test::PlaneFigures f = match_plane({.disparity_px = 28, .noise = 1}, 60, options);
    EXPECT_GT(f.density, 0.7) << static_cast<int>(filter);
    EXPECT_LT(f.mismatch, 0.02) << static_cast<int>(filter);
  }
}

TEST(StretchCorrelation, CoarseToFineSearchesLessAndFindsTheSame) {
  const test::LeafPlane plane{.disparity_px = 40, .by_x = 0.1};
  const RectifiedPair pair = leaf_pair(plane, 306);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const auto searched = [](const StretchFrame& frame) {
    long sum = 0;
    for (const StretchBlock& block : frame.blocks.blocks) sum += block.searched;
    return sum;
  };
  StretchOptions options;
  options.halvings = 0;
  const StretchFrame all = match_by_stretch(pair, edges, {0, 90}, options);
  const test::PlaneFigures of_all = test::figures(plane, edges, all.at_edges);
  for (const int halvings : {1, 2}) {
    options.halvings = halvings;
    const StretchFrame some = match_by_stretch(pair, edges, {0, 90}, options);
    EXPECT_LT(searched(some), searched(all) / 3);
    EXPECT_GT(test::figures(plane, edges, some.at_edges).density, of_all.density - 0.02);
    EXPECT_LT(test::figures(plane, edges, some.at_edges).mismatch, 0.01);
  }
}

std::vector<std::uint32_t> bits(const std::vector<EdgeDisparity>& found) {
  std::vector<std::uint32_t> result;
  for (const EdgeDisparity& at : found) {
    result.push_back(std::bit_cast<std::uint32_t>(at.disparity_px));
    result.push_back(std::bit_cast<std::uint32_t>(at.confidence));
  }
  return result;
}

TEST(StretchCorrelation, SameBitsForAnyNumberOfThreads) {
  const RectifiedPair pair = leaf_pair({.disparity_px = 24, .by_x = 0.1}, 307);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  StretchOptions options;
  const StretchFrame one = match_by_stretch(pair, edges, {0, 60}, options);
  const StretchFrame after_one = match_by_stretch(pair, edges, {0, 60}, options, &one);
  for (const int threads : {2, 5, 0}) {
    options.threads = threads;
    const StretchFrame many = match_by_stretch(pair, edges, {0, 60}, options);
    EXPECT_EQ(bits(many.at_edges), bits(one.at_edges));
    EXPECT_EQ(bits(match_by_stretch(pair, edges, {0, 60}, options, &many).at_edges),
              bits(after_one.at_edges));
  }
}

/// The kept block of the best score that holds an edge.
const StretchBlock* surest(const StretchBlocks& grid, const EdgePoint& edge) {
  const StretchBlock* best = nullptr;
  for (const StretchBlock& b : grid.blocks) {
    if (b.fate != BlockStatus::kept || std::abs(b.x - edge.x) > 8 || std::abs(b.y - edge.y) > 4) {
      continue;
    }
    if (!best || b.score > best->score) best = &b;
  }
  return best;
}

TEST(StretchCorrelation, DisparitiesLieBetweenLikeEdges) {
  const RectifiedPair pair = leaf_pair({.disparity_px = 24, .by_x = 0.1}, 308);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const StretchOptions options;
  const std::vector<EdgePoint> right = canny_edges(pair.right, options.right_edges);
  const StretchFrame frame = match_by_stretch(pair, edges, {0, 60}, options);
  int matched = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const EdgeDisparity& at = frame.at_edges[i];
    if (!at.matched()) {
      EXPECT_EQ(at.confidence, 0);
      continue;
    }
    ++matched;
    EXPECT_TRUE(std::isnan(at.sigma_px));
    const EdgePoint& edge = edges[i];
    bool like = false;
    for (const EdgePoint& other : right) {
      if (std::abs(other.y - edge.y) > 1 || other.normal.x() * edge.normal.x() <= 0) continue;
      const float down = static_cast<float>(edge.y) - other.pixel_px.y();
      const float crossing = other.y == edge.y
                                 ? other.row_x_px
                                 : other.pixel_px.x() - down * other.normal.y() / other.normal.x();
      like |= std::abs(crossing - (edge.row_x_px - at.disparity_px)) < 1e-3f;
    }
    EXPECT_TRUE(like) << i;
    const StretchBlock* const best = surest(frame.blocks, edge);
    ASSERT_TRUE(best);
    EXPECT_EQ(best->score, at.confidence);
    const float across = edge.row_x_px - static_cast<float>(best->x);
    EXPECT_NEAR(best->disparity_px + (1 - best->stretch) * across, at.disparity_px, 2.001);
  }
  EXPECT_GT(matched, 1000);
}

TEST(StretchCorrelation, LeftAndRightMayBeSwapped) {
  const RectifiedPair pair = leaf_pair({.disparity_px = 24}, 309);
  const RectifiedPair swapped{pair.right, pair.left};
  int matched = 0, right = 0;
  for (const EdgeDisparity& at :
       stretch_matcher().match(swapped, canny_edges(swapped.left), {-60, 0})) {
    if (!at.matched()) continue;
    ++matched;
    right += std::abs(at.disparity_px + 24) < 1 ? 1 : 0;
  }
  EXPECT_GT(matched, 1000);
  EXPECT_GT(right, 0.97 * matched);
}

TEST(StretchCorrelation, BlankAndTinyImages) {
  const EdgePoint edge{.x = 0, .y = 0, .pixel_px = {0, 0}, .normal = {1, 0}, .strength = 10};
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {9, 40}, {200, 100}}) {
    const auto pixels = static_cast<std::size_t>(width * height);
    const GreyLevels blank{width, height, std::vector<float>(pixels, 90.0f)};
    const RectifiedPair pair{blank, blank};
    StretchOptions options;
    options.min_edges = 1;
    const DisparityRange range{0, std::min(20, width - 1)};
    const StretchFrame frame = match_by_stretch(pair, {edge}, range, options);
    ASSERT_EQ(frame.at_edges.size(), 1U);
    EXPECT_FALSE(frame.at_edges[0].matched());
    EXPECT_TRUE(stretch_matcher().match(pair, {}, range).empty());
  }
  const RectifiedPair small = leaf_pair({.width_px = 12, .height_px = 7, .disparity_px = 1}, 310);
  EXPECT_EQ(stretch_matcher().match(small, {edge}, {-11, 11}).size(), 1U);
}

TEST(StretchCorrelation, RefusesOptionsThatLeaveNothing) {
  const RectifiedPair pair = leaf_pair({.width_px = 60, .height_px = 40, .disparity_px = 5}, 311);
  const std::vector<std::function<void(StretchOptions&)>> faults = {
      [](auto& o) { o.width_px = 16; },        [](auto& o) { o.height_px = 0; },
      [](auto& o) { o.step_x_px = 0; },        [](auto& o) { o.stretches = 4; },
      [](auto& o) { o.max_gradient = 2; },     [](auto& o) { o.shears = 0; },
      [](auto& o) { o.rank_reach_px = 12; },   [](auto& o) { o.halvings = -1; },
      [](auto& o) { o.edge_reach_px = NAN; },  [](auto& o) { o.scale_px = 0; },
      [](auto& o) { o.rank_least_grey = -1; },
  };
  for (std::size_t k = 0; k < faults.size(); ++k) {
    StretchOptions options;
    faults[k](options);
    EXPECT_NE(test::error_message([&] {
                stretch_matcher(options).match(pair, {}, {0, 20});
              }),
              "")
        << k;
  }
}

}  // namespace
}  // namespace vernier
