// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Grey levels on both sides of edges, and the tone curve between two images.
#include "stereo/matching/side_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/edges/edge_points_by_row.h"
#include "stereo/grey_levels.h"
#include "stereo/matching/census.h"
#include "stereo/matching/edge_support.h"
#include "stereo/matching/tone_curve.h"
#include "tests/support/grey_levels.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

using test::clamped;
using test::random_image;

/// Draws of this file, beside those of random images.
RandomStream side_draws(std::uint64_t seed) {
  return RandomStream({.seed = seed, .source = static_cast<std::uint32_t>(DrawSource::noisy_copy)});
}

TEST(SideLevels, AreMeansOfNinePixels) {
  const GreyLevels image = random_image(70, 9, 301);
  const LevelImage levels = mean_levels(image, 6), turned = mirrored(levels);
  for (int y = 0; y < 9; ++y) {
    for (int x = -6; x < 76; ++x) {
      const int at = std::clamp(x, 0, 69);
      float sum = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) sum += clamped(image, at + i, y + j);
      }
      EXPECT_NEAR(levels.row(y)[x], sum / 9, 0.5 + 1e-4);
      EXPECT_EQ(turned.row(y)[69 - x], levels.row(y)[x]);
    }
  }
}

TEST(SideLevels, OffsetsAreTwoPixelsAlongTheNormal) {
  EXPECT_EQ(side_offset({1, 0}), (SideOffset{2, 0}));
  EXPECT_EQ(side_offset({-0.7f, 0.7f}), (SideOffset{-1, 1}));
  EXPECT_EQ(side_offset({1e20f, -std::numeric_limits<float>::infinity()}), (SideOffset{2, -2}));
  EXPECT_EQ(side_offset({std::numeric_limits<float>::quiet_NaN(), 1}), (SideOffset{0, 2}));
}

TEST(SideLevels, AddTheirDifferencesToTheCosts) {
  constexpr int width = 90, height = 12, disparities = 32, border = 40;
  const GreyLevels left = random_image(width, height, 302),
                   right = random_image(width, height, 303);
  const CensusImage own = census_transform(left, border),
                    other = mirrored(census_transform(right, border));
  const LevelImage own_levels = mean_levels(left, border),
                   right_levels = mean_levels(right, border), there = mirrored(right_levels);
  std::vector<int> x, y, first;
  std::vector<SideOffset> offsets;
  RandomStream draws = side_draws(304);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; column += 1 + static_cast<int>(draws.below(9))) {
      x.push_back(column);
      y.push_back(row);
      first.push_back(width - 1 - column);
      offsets.push_back(
          {static_cast<int>(draws.below(5)) - 2, static_cast<int>(draws.below(5)) - 2});
    }
  }
  const PointsByRow points = points_by_row(x, y, height);
  constexpr int tolerance = 5;
  const SideLevels sides{own_levels, there, offsets, tolerance};
  CensusCosts plain{points, own, other, first, Facing::opposite, disparities}, both = plain;
  both.sides = &sides;
  std::vector<std::int16_t> of_census(disparities), costs(disparities);
  for (int p = 0; p < points.size(); ++p) {
    const auto k = static_cast<std::size_t>(p);
    census_costs(plain, p, of_census.data());
    census_costs(both, p, costs.data());
    for (int d = 0; d < disparities; ++d) {
      const int at = points.x[k] - d;
      int cost = of_census[static_cast<std::size_t>(d)];
      if (at >= 0) {
        for (const int side : {1, -1}) {
          const int row = std::clamp(points.y[k] + side * offsets[k][1], 0, height - 1);
          const int apart = own_levels.row(row)[points.x[k] + side * offsets[k][0]] -
                            right_levels.row(row)[at + side * offsets[k][0]];
          cost += side_weight * std::clamp<int>(std::abs(apart) - tolerance, 0, most_side_levels);
        }
      }
      ASSERT_EQ(costs[static_cast<std::size_t>(d)], cost) << p << " " << d;
      if (at >= 0) {
        ASSERT_LT(cost, no_place_cost);
      }
    }
  }
}

TEST(Tones, AreTheUsualDifference) {
  RandomStream draws = side_draws(305);
  std::vector<LevelPair> pairs;
  const auto brighter = [](double level) { return 30 + 0.8 * level; };
  for (int i = 0; i < 900; ++i) {
    const int from = 20 + static_cast<int>(draws.below(200));
    const bool is_wrong = draws.uniform() < 0.3;
    pairs.push_back({from, is_wrong ? static_cast<int>(draws.below(256))
                                    : static_cast<int>(std::lround(brighter(from)))});
  }
  const ToneCurve curve = tones_of(pairs).value().curve;
  for (std::size_t level = 40; level < 200; ++level) {
    EXPECT_NEAR(curve[level], brighter(static_cast<double>(level)), 4) << level;
  }
  EXPECT_TRUE(std::is_sorted(curve.begin(), curve.end()));
  // Too few pairs say nothing.
  EXPECT_FALSE(tones_of({pairs.begin(), pairs.begin() + 14}).has_value());
}

TEST(Tones, TolerateWhatLightChanges) {
  RandomStream draws = side_draws(310);
  const auto tolerance_at = [&](double sigma) {
    std::vector<LevelPair> pairs;
    for (int i = 0; i < 4000; ++i) {
      const int from = 60 + static_cast<int>(draws.below(130));
      pairs.push_back({from, static_cast<int>(std::lround(from + sigma * draws.normal()))});
    }
    return tones_of(pairs).value().tolerance;
  };
  constexpr double quartile = 1.1503;  // of |N(0, 1)|, the upper one
  EXPECT_EQ(tolerance_at(0), 0);
  EXPECT_NEAR(tolerance_at(4), 1.5 * quartile * 4, 1.5);
  EXPECT_NEAR(tolerance_at(16), 1.5 * quartile * 16, 1.5);
}

/// Upright bars of equal width and distance, but of different greys: by the signs of the steps
/// alone, each is like all others. With `strip`, texture below them and apart, which tells the
/// tones.
GreyLevels bars(int width, int shift_px, double gamma, bool has_strip) {
  constexpr int period = 24, bar = 9;
  GreyLevels image{width, 90, {}};
  const GreyLevels strip = random_image(width, 90, 307);
  RandomStream draws = side_draws(306);
  std::vector<double> greys;
  for (int i = 0; i < 2 + width / period; ++i) greys.push_back(110 + 100 * draws.uniform());
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < width; ++x) {
      const int at = x + shift_px;
      double grey = at % period < bar ? greys[static_cast<std::size_t>(at / period)] : 60;
      if (y >= 60) grey = has_strip && y >= 70 ? 40 + 0.7 * strip(at / 3, y / 3) : 60;
      image.values.push_back(static_cast<float>(255 * std::pow(grey / 255, gamma)));
    }
  }
  return image;
}

/// Share of the bars' edges that are found at their disparity; smaller ones match as well.
double share_of_bars_found(double gamma, bool has_strip) {
  constexpr int disparity_px = 48 - 14;  // one and a half periods
  const RectifiedPair pair{bars(600, 0, 1, has_strip), bars(600, disparity_px, gamma, has_strip)};
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const std::vector<EdgeMatch> matches =
      match_edges(pair, edges, {0, 64}, {.compare_levels = true});
  int inner = 0, right = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].x < 80 || edges[i].y > 56) continue;
    ++inner;
    right += std::abs(matches[i].at.disparity_px - disparity_px) < 0.5;
  }
  EXPECT_GT(inner, 1500);
  return static_cast<double>(right) / inner;
}

TEST(EdgeMatcher, TellsBarsByTheirGreys) {
  EXPECT_GT(share_of_bars_found(1, true), 0.95);
  EXPECT_GT(share_of_bars_found(1.4, true), 0.95);
  // Nothing tells the tones: by the census alone all bars are alike.
  EXPECT_LT(share_of_bars_found(1, false), 0.3);
}

/// Upright bars all alike in front of texture, whose ends alone tell which is which. The light of
/// the right image varies along the rows, by so many levels either way.
double share_of_like_bars_found(double light, bool compare_levels) {
  constexpr int width = 600, height = 120, period = 24, bar = 11, disparity_px = 30;
  const GreyLevels texture = random_image(width, height, 311);
  const auto image = [&](int shift_px, double amplitude) {
    GreyLevels made{width, height, {}};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int at = x + shift_px;
        const bool is_board = at >= 200 && at < 200 + 10 * period && y >= 25 && y < 95;
        double grey = 60 + 0.4 * texture((at / 3) % width, y / 3);
        if (is_board) grey = (at - 200) % period < bar ? 40 : 190;
        made.values.push_back(static_cast<float>(grey + amplitude * std::sin(at / 15.0)));
      }
    }
    return made;
  };
  const RectifiedPair pair{image(0, 0), image(disparity_px, light)};
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  const std::vector<EdgeMatch> matches =
      match_edges(pair, edges, {0, 96}, {.compare_levels = compare_levels});
  int inner = 0, right = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const EdgePoint& edge = edges[i];
    if (edge.x < 204 || edge.x > 196 + 10 * period || edge.y < 30 || edge.y > 90) continue;
    ++inner;
    right += std::abs(matches[i].at.disparity_px - disparity_px) < 0.5;
  }
  EXPECT_GT(inner, 500);
  return static_cast<double>(right) / inner;
}

TEST(EdgeMatcher, DoesNotMistakeALikeBarForLightThatDiffers) {
  EXPECT_TRUE(EdgeMatcherOptions{}.compare_levels);
  for (const double light : {0.0, 3.0}) {
    EXPECT_GE(share_of_like_bars_found(light, true), share_of_like_bars_found(light, false) - 0.02)
        << light;
  }
}

TEST(EdgeMatcher, FewDisparitiesTellNoTones) {
  const RectifiedPair pair{random_image(120, 40, 308), random_image(120, 40, 309)};
  const std::vector<EdgePoint> edges = canny_edges(pair.left);
  EXPECT_EQ(match_edges(pair, edges, {0, 2}, {.compare_levels = true}).size(), edges.size());
}

}  // namespace
}  // namespace vernier
