// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Leaves of seeds from 1 on were looked at while the matcher was made; those here are from 201 on.
#include "stereo/edge_matcher.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_points_by_row.h"
#include "stereo/grey_levels.h"
#include "stereo/image/stretched_image.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/matching/census.h"
#include "stereo/matching/edge_support.h"
#include "stereo/stereo_truth.h"
#include "tests/support/error_message.h"
#include "tests/support/grey_levels.h"
#include "tests/support/leaf_pair.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

using test::random_image;

TEST(Census, SaysWhichPixelsAreBrighter) {
  const GreyLevels image = random_image(300, 12, 201);
  const CensusImage census = census_transform(image, 8);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 300; ++x) {
      std::uint64_t bits = 0;
      for (int j = -3; j <= 3; ++j) {
        for (int i = -4; i <= 4; ++i) {
          if (i == 0 && j == 0) continue;
          bits = (bits << 1) | (test::clamped(image, x + i, y + j) > image(x, y));
        }
      }
      ASSERT_EQ(census.row(y)[x], bits) << x << " " << y;
    }
  }
}

/// A few points in two images.
class EdgeSupportCosts : public testing::Test {
 protected:
  static constexpr int width = 90, height = 24, disparities = 32;

  EdgeSupportCosts() {
    RandomStream draws({.seed = 202, .source = static_cast<std::uint32_t>(DrawSource::noisy_copy)});
    std::vector<int> x, y;
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        if (draws.uniform() > 0.12) continue;
        x.push_back(column);
        y.push_back(row);
      }
    }
    points = points_by_row(x, y, height);
    for (const int at : points.x) first.push_back(width - 1 - at);
  }

  /// By the definition, word by word.
  int cost(int p, int d) const {
    const auto k = static_cast<std::size_t>(p);
    const int at = points.x[k] - d;
    if (at < 0) return no_place_cost;
    int sum = 0;
    for (int j = -1; j <= 1; ++j) {
      const int row = std::clamp(points.y[k] + j, 0, height - 1);
      for (int i = -1; i <= 1; ++i) {
        const int own = std::clamp(points.x[k] + i, 0, width - 1);
        sum += std::popcount(left.row(row)[own] ^ right.row(row)[at + i]);
      }
    }
    return sum;
  }

  const CensusImage left = census_transform(random_image(width, height, 203), 40);
  const CensusImage right = census_transform(random_image(width, height, 204), 40);
  const CensusImage mirror = mirrored(right);
  PointsByRow points;
  std::vector<int> first;
};

TEST_F(EdgeSupportCosts, CostsAreHammingDistances) {
  const CensusCosts at{points, left, mirror, first, Facing::opposite, disparities};
  std::vector<std::int16_t> costs(disparities);
  for (int p = 0; p < points.size(); ++p) {
    census_costs(at, p, costs.data());
    for (int d = 0; d < disparities; ++d) {
      ASSERT_EQ(costs[static_cast<std::size_t>(d)], cost(p, d)) << p << " " << d;
    }
  }
}

TEST_F(EdgeSupportCosts, AViewStretchedByOneIsTheImageItself) {
  // The least of it and the plain costs, without a penalty, are the plain costs; and where the
  // plain image is of something else, those of the view.
  const GreyLevels own = random_image(width, height, 204);
  const GreyLevels turned = mirrored(stretched(mirrored(own), 1));
  std::vector<StretchedView> views{{1, mirrored(census_transform(turned, 120))}};
  const CensusImage noise = mirrored(census_transform(random_image(width, height, 205), 40));
  CensusCosts at{points, left, noise, first, Facing::opposite, disparities, &views, -600};
  std::vector<std::int16_t> costs(disparities);
  for (int p = 0; p < points.size(); ++p) {
    census_costs(at, p, costs.data());
    for (int d = 0; d < disparities; ++d) {
      ASSERT_EQ(costs[static_cast<std::size_t>(d)] + 600, cost(p, d)) << p << " " << d;
    }
  }
}

TEST_F(EdgeSupportCosts, NeighboursAreTheNearestInReach) {
  for (int p = 0; p < points.size(); ++p) {
    const auto k = static_cast<std::size_t>(p);
    const auto nearest = [&](int x, int y, int reach) {
      int best = -1, away = reach + 1;
      for (int q = 0; q < points.size(); ++q) {
        const auto m = static_cast<std::size_t>(q);
        const int distance = std::abs(points.x[m] - x);
        if (points.y[m] != y || distance > std::min(away, reach)) continue;
        if (distance == away && points.x[m] < x) continue;
        best = q;
        away = distance;
      }
      return best;
    };
    const int x = points.x[k], y = points.y[k];
    EXPECT_EQ(points.neighbours[k][2], nearest(x - 2, y - 1, 2));
    EXPECT_EQ(points.neighbours[k][3], nearest(x + 2, y - 1, 2));
    EXPECT_EQ(points.neighbours[k][6], nearest(x + 2, y + 1, 2));
    EXPECT_EQ(points.neighbours[k][7], nearest(x - 2, y + 1, 2));
    int above = nearest(x, y - 1, 2);
    if (above < 0) above = nearest(x, y - 2, 3);
    if (above < 0) above = nearest(x, y - 3, 3);
    EXPECT_EQ(points.neighbours[k][1], above);
  }
}

TEST_F(EdgeSupportCosts, WinnersAreThoseOfTheRecursion) {
  const SupportOptions options;
  const auto n = static_cast<std::size_t>(points.size());
  std::vector<std::vector<int>> sums(n, std::vector<int>(disparities, 0));
  for (int r = 0; r < 8; ++r) {
    std::vector<std::vector<int>> L(n, std::vector<int>(disparities));
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t p = r < 4 ? k : n - 1 - k;
      const int from = points.neighbours[p][static_cast<std::size_t>(r)];
      const double gap = from < 0 ? 1e9 : points.distance_px(static_cast<int>(p), from);
      for (int d = 0; d < disparities; ++d) {
        const auto D = static_cast<std::size_t>(d);
        int support = 0;
        if (gap <= 2 * options.reach_px) {
          const double share = std::clamp(1 - (gap - 1) / options.reach_px, options.min_share, 1.0);
          const std::vector<int>& other = L[static_cast<std::size_t>(from)];
          const int least = *std::min_element(other.begin(), other.end());
          const int small = static_cast<int>(static_cast<float>(share) * options.small_step);
          const int large = static_cast<int>(static_cast<float>(share) * options.large_step);
          support = std::min(other[D], least + large);
          if (d > 0) support = std::min(support, other[D - 1] + small);
          if (d + 1 < disparities) support = std::min(support, other[D + 1] + small);
          support -= least;
        }
        L[p][D] = cost(static_cast<int>(p), d) + support;
        sums[p][D] += L[p][D];
      }
    }
  }
  const std::vector<Winner> winners =
      semi_global_disparities({points, left, mirror, first, Facing::opposite, disparities},
                              stereo::internal::Support::all, options);
  int same = 0;
  for (std::size_t p = 0; p < n; ++p) {
    const auto best = std::min_element(sums[p].begin(), sums[p].end()) - sums[p].begin();
    same += winners[p].index == best;
  }
  // Shares are rounded in single precision there: a step's price may differ by one.
  EXPECT_GT(same, 0.98 * static_cast<double>(n));
}

TEST(EdgeMatcher, SearchesTheRangeAndNothingElse) {
  const RectifiedPair pair = test::leaf_pair({.disparity_px = 25}, 230);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const auto within = match_edges(pair, edges, {20, 30});
  int matched = 0;
  for (const EdgeMatch& match : within) {
    if (!match.at.matched()) continue;
    ++matched;
    EXPECT_GT(match.at.disparity_px, 19);
    EXPECT_LT(match.at.disparity_px, 31);
  }
  EXPECT_GT(matched, 0.8 * static_cast<double>(edges.size()));
  const RectifiedPair crossed{pair.right, pair.left};  // disparities below 0
  const std::vector<EdgePoint> other = canny_edges(crossed.left);
  int negative = 0;
  for (const EdgeMatch& match : match_edges(crossed, other, {-40, 0})) {
    negative += match.at.matched() && std::abs(match.at.disparity_px + 25) < 1;
  }
  EXPECT_GT(negative, 0.8 * static_cast<double>(other.size()));
}

TEST(EdgeMatcher, SaysTheSameTwice) {
  const RectifiedPair pair = test::leaf_pair({}, 231);
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const auto one = match_edges(pair, edges, {0, 40}), two = match_edges(pair, edges, {0, 40});
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(one[i].at.disparity_px),
              std::bit_cast<std::uint32_t>(two[i].at.disparity_px));
  }
}

TEST(EdgeMatcher, NamesWhatItCannotTake) {
  RectifiedPair pair{random_image(60, 40, 1), random_image(60, 30, 2)};
  EXPECT_NE(test::error_message([&] {
              match_edges(pair, {}, {0, 20});
            }).find("60x40"),
            std::string::npos);
  pair.right = pair.left;
  EXPECT_NE(test::error_message([&] {
              match_edges(pair, {}, {5, 4});
            }).find("range 5 to 4"),
            std::string::npos);
  EXPECT_NE(test::error_message([&] {
              match_edges(pair, {}, {0, 60});
            }).find("width"),
            std::string::npos);
  EXPECT_TRUE(match_edges(pair, {}, {0, 20}).empty());
  std::vector<EdgePoint> outside(1);
  outside[0].y = 40;
  EXPECT_NE(test::error_message([&] {
              match_edges(pair, outside, {0, 20});
            }).find("outside"),
            std::string::npos);
  const RectifiedPair strip{random_image(2200, 12, 3), random_image(2200, 12, 4)};
  const std::vector<EdgePoint> many = canny_edges(strip.left);
  EXPECT_EQ(match_edges(strip, many, {-2190, 2190}).size(), many.size());
  const GreyLevels blank{60, 40, std::vector<float>(2400, 100.0f)};
  EXPECT_TRUE(canny_edges(blank).empty());
}

/// Five edges; the right image does not show the fourth, and the fifth is at a step.
class Evaluation : public testing::Test {
 protected:
  Evaluation() {
    for (int i = 0; i < 5; ++i) {
      EdgePoint edge;
      edge.x = 20 + i;
      edge.pixel_px = Eigen::Vector2f(edge.x, edge.y);
      edge.normal = {1, 0};
      edges.push_back(edge);
      TruthAtEdge at;
      at.known = true;
      at.disparity_px = at.own_px = at.min_px = at.max_px = 10;
      truth.push_back(at);
      found.push_back({10, 0.5f, static_cast<float>(i)});
    }
    truth[3].occluded = truth[3].own_occluded = true;
    truth[4].discontinuity = true;
    truth[4].min_px = 4;
  }
  std::vector<EdgePoint> edges;
  std::vector<TruthAtEdge> truth;
  std::vector<EdgeDisparity> found;
};

TEST_F(Evaluation, CountsByTheProtocol) {
  found[0].disparity_px = 10.6f;
  found[1].disparity_px = std::numeric_limits<float>::quiet_NaN();
  found[2].disparity_px = 14;
  found[3].disparity_px = 2;  // occluded and wrong
  found[4].disparity_px = 4;  // the background
  const MatcherScore either = evaluate(edges, found, truth, 100);
  EXPECT_EQ(either.all.edges, 4);
  EXPECT_EQ(either.all.matched, 3);
  EXPECT_DOUBLE_EQ(either.all.density, 0.75);
  EXPECT_DOUBLE_EQ(either.all.bad_0_5, 2.0 / 3);
  EXPECT_DOUBLE_EQ(either.all.bad_1, 1.0 / 3);
  EXPECT_DOUBLE_EQ(either.mismatch, 2.0 / 4);
  EXPECT_EQ(either.occluded, 1);
  EXPECT_EQ(either.occluded_matched, 1);
  EXPECT_EQ(either.stated, 2);
  EXPECT_DOUBLE_EQ(either.coverage_95, 0.5);
  EXPECT_NEAR(either.smooth.rms_inlier_px, 0.6, 1e-6);
  EvaluationOptions strict;
  strict.outline = DiscontinuityRule::foreground;
  EXPECT_DOUBLE_EQ(evaluate(edges, found, truth, 100, strict).all.bad_1, 2.0 / 3);
  EXPECT_DOUBLE_EQ(evaluate(edges, found, truth, 100, strict).mismatch, 3.0 / 4);
  edges[0].normal = {0.05f, 1};  // along the row: not asked
  EXPECT_EQ(evaluate(edges, found, truth, 100).all.edges, 3);
  EXPECT_EQ(evaluate(edges, found, truth, 25).all.edges, 1);  // within the border of the image
}

TEST_F(Evaluation, TheCurveFallsWithConfidence) {
  found[0].disparity_px = 20;  // the least sure is wrong
  const std::vector<CurvePoint> curve = density_curve(edges, found, truth, 100, {.points = 5});
  ASSERT_EQ(curve.size(), 5u);
  EXPECT_DOUBLE_EQ(curve.front().density, 1);
  EXPECT_DOUBLE_EQ(curve.front().bad_1, 0.25);
  EXPECT_DOUBLE_EQ(curve[1].bad_1, 0);
  EXPECT_DOUBLE_EQ(curve[1].density, 0.75);
  EXPECT_DOUBLE_EQ(bad_1_at(curve, 0.875), 0.125);
  EXPECT_DOUBLE_EQ(bad_1_at(curve, 2), 0.25);
  EXPECT_DOUBLE_EQ(bad_1_at(curve, 0.1), 0);
}

TEST_F(Evaluation, MoreCurvePointsThanMatches) {
  for (std::size_t i = 2; i < found.size(); ++i) found[i] = {};
  found[0].confidence = std::numeric_limits<float>::quiet_NaN();
  const std::vector<CurvePoint> curve = density_curve(edges, found, truth, 100, {.points = 10});
  ASSERT_FALSE(curve.empty());
  EXPECT_DOUBLE_EQ(curve.front().density, 0.5);
}

TEST_F(Evaluation, NeedsOneOfEach) {
  truth.pop_back();
  EXPECT_EQ(test::error_message([&] { evaluate(edges, found, truth, 100); }),
            "evaluation: edges, disparities and truth differ in number; give one of each per edge");
}

}  // namespace
}  // namespace vernier
