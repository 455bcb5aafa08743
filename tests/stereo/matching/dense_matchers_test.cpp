// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/matching/dense_matchers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matching/edge_sampling.h"
#include "tests/support/edge_at.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

constexpr int scene_width = 220, scene_height = 60;

/// Random grey of every pixel of a plane that is wider than the images.
GreyLevels texture(int from, int columns = scene_width) {
  GreyLevels grey{columns, scene_height, {}};
  for (int y = 0; y < scene_height; ++y) {
    for (int x = 0; x < columns; ++x) {
      RandomStream draws({.seed = 71,
                          .trial = static_cast<std::uint32_t>(x + from + 1000),
                          .feature = static_cast<std::uint32_t>(y),
                          .source = 200});
      grey.values.push_back(static_cast<float>(draws.uniform(20, 235)));
    }
  }
  return grey;
}

/// A plane of one disparity: the right image shows at x what the left one does at x + d.
RectifiedPair plane(int disparity) { return {texture(0), texture(disparity)}; }

using MapOf = std::function<DisparityMap(const RectifiedPair&, const DisparityRange&)>;

const std::vector<std::pair<std::string, MapOf>>& maps() {
  static const std::vector<std::pair<std::string, MapOf>> all = [] {
    std::vector<std::pair<std::string, MapOf>> made;
    made.emplace_back("bm", [](const auto& p, const auto& r) { return bm_map(p, r); });
    for (const SgbmMode mode : {SgbmMode::five_paths, SgbmMode::eight_paths, SgbmMode::three_ways,
                                SgbmMode::four_paths}) {
      SgbmOptions options;
      options.mode = mode;
      made.emplace_back(
          "sgbm " + std::to_string(static_cast<int>(mode)),
          [options](const auto& p, const auto& r) { return sgbm_map(p, r, options); });
    }
    return made;
  }();
  return all;
}

/// Share of the columns from `first` up to `last` that have the disparity.
double share(const DisparityMap& map, int first, int last, float disparity) {
  int right = 0;
  for (int y = 0; y < scene_height; ++y) {
    for (int x = first; x < last; ++x) right += std::abs(map(x, y) - disparity) < 0.3f;
  }
  return static_cast<double>(right) / ((last - first) * scene_height);
}

int known_outside(const DisparityMap& map, float least, float most) {
  int count = 0;
  for (int i = 0; i < scene_width * scene_height; ++i) {
    const float d = map.values[static_cast<std::size_t>(i)];
    const float right = static_cast<float>(i % scene_width) - d;
    count += d < least || d > most || right < -0.5f || right > scene_width - 0.5f;
  }
  return count;
}

/// OpenCV itself leaves out the first 47 columns of such a search.
TEST(DenseMatchers, MatchTheBandBesideTheBorderToo) {
  for (const auto& [label, map_of] : maps()) {
    const DisparityMap map = map_of(plane(9), {0, 40});
    ASSERT_EQ(map.values.size(), static_cast<std::size_t>(scene_width * scene_height));
    EXPECT_GT(share(map, 0, scene_width, 9), 0.93) << label;
    EXPECT_GT(share(map, 12, 47, 9), 0.97) << label;
    EXPECT_GT(share(map, scene_width - 10, scene_width, 9), 0.85) << label;
    EXPECT_EQ(known_outside(map, 0, 40.5), 0) << label;
  }
}

TEST(DenseMatchers, SearchTheRangeThatIsAskedFor) {
  for (const auto& [label, map_of] : maps()) {
    EXPECT_GT(share(map_of(plane(30), {3, 30}), 33, scene_width, 30), 0.95) << label;
    EXPECT_GT(share(map_of(plane(5), {5, 6}), 8, scene_width, 5), 0.95) << label;
    EXPECT_GT(share(map_of(plane(-12), {-20, -5}), 0, scene_width - 15, -12), 0.95) << label;
    // 33 is among the 32 disparities from 3 that OpenCV searches, but not asked for
    const DisparityMap beyond = map_of(plane(33), {3, 30});
    EXPECT_EQ(known_outside(beyond, 3, 30.5), 0) << label;
    EXPECT_EQ(share(beyond, 0, scene_width, 33), 0) << label;
  }
}

/// OpenCV takes the step that ends a region in pixels for SGBM, and in sixteenths for BM.
TEST(DenseMatchers, KeepSlantedPlanesWhole) {
  constexpr float gradient = 0.2f;
  RectifiedPair pair = plane(0);
  for (int y = 0; y < scene_height; ++y) {
    for (int x = 0; x < scene_width; ++x) {
      const float at = std::min(static_cast<float>(x) / (1 - gradient), scene_width - 1.001f);
      const int first = static_cast<int>(at);
      const float part = at - static_cast<float>(first);
      pair.right.values[static_cast<std::size_t>(y * scene_width + x)] =
          (1 - part) * pair.left(first, y) + part * pair.left(first + 1, y);
    }
  }
  const auto right_ones = [&](const DisparityMap& map) {
    int right = 0;
    for (int i = 0; i < scene_width * scene_height; ++i) {
      right += std::abs(map.values[static_cast<std::size_t>(i)] - gradient * (i % scene_width)) < 1;
    }
    return right;
  };
  BmOptions bm_all;
  SgbmOptions sgbm_all;
  bm_all.speckle_px = sgbm_all.speckle_px = 0;
  const DisparityRange range{0, 47};
  EXPECT_GT(right_ones(bm_map(pair, range)), 0.9 * right_ones(bm_map(pair, range, bm_all)));
  EXPECT_GT(right_ones(sgbm_map(pair, range)), 0.9 * right_ones(sgbm_map(pair, range, sgbm_all)));
  EXPECT_GT(right_ones(bm_map(pair, range)), 0.4 * scene_width * scene_height);
}

TEST(DenseMatchers, AreTheSameForAnyNumberOfThreads) {
  const RectifiedPair pair = plane(9);
  const int threads = cv::getNumThreads();
  for (const auto& [label, map_of] : maps()) {
    cv::setNumThreads(1);
    const DisparityMap one = map_of(pair, {0, 40});
    cv::setNumThreads(4);
    const DisparityMap four = map_of(pair, {0, 40});
    cv::setNumThreads(threads);
    for (std::size_t i = 0; i < one.values.size(); ++i) {
      ASSERT_TRUE(one.values[i] == four.values[i] ||
                  (std::isnan(one.values[i]) && std::isnan(four.values[i])))
          << label;
    }
  }
}

TEST(DenseMatchers, GiveTheMapAtEdges) {
  const std::vector<EdgePoint> edges = {test::edge_at(50.3f, 20), test::edge_at(120, 41),
                                        test::edge_at(2, 5)};
  for (const Matcher& matcher : {bm(), sgbm()}) {
    EXPECT_FALSE(matcher.of_edges);
    const auto found = matcher.match(plane(9), edges, {0, 40});
    ASSERT_EQ(found.size(), 3u);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(found[i].disparity_px, 9, 0.3) << matcher.name;
      EXPECT_EQ(found[i].confidence, 1);
      EXPECT_TRUE(std::isnan(found[i].sigma_px));
    }
    EXPECT_NE(found[2].disparity_px, 9) << "its match is outside of the right image";
  }
  EXPECT_EQ(bm().name, "bm");
  EXPECT_EQ(sgbm().name, "sgbm");
}

/// The same disparities, fewer of them, as more is asked of a match.
TEST(DenseMatchers, BecomeSparserByUniqueness) {
  RectifiedPair pair = plane(9);
  RandomStream draws({.seed = 72, .source = 200});
  for (float& grey : pair.right.values) {
    grey += static_cast<float>(60 * draws.normal());
    grey = std::clamp(grey, 0.0f, 255.0f);
  }
  std::vector<EdgePoint> edges;
  for (int i = 0; i < 3000; ++i) {
    edges.push_back(test::edge_at(static_cast<float>(30 + i % 160), 5 + i / 160));
  }
  for (const auto& matchers : {by_uniqueness(BmOptions{}), by_uniqueness(SgbmOptions{})}) {
    ASSERT_EQ(matchers.size(), 9u);
    EXPECT_EQ(matchers[2].name.substr(matchers[2].name.find(' ')), " 5 %");
    std::vector<int> matched;
    for (const Matcher& matcher : matchers) {
      matched.push_back(0);
      for (const EdgeDisparity& d : matcher.match(pair, edges, {0, 40})) {
        matched.back() += d.matched();
      }
    }
    EXPECT_TRUE(std::is_sorted(matched.rbegin(), matched.rend())) << matchers[0].name;
    EXPECT_GT(matched.front(), 1500) << matchers[0].name;
    EXPECT_LT(matched.back(), 0.7 * matched.front()) << matchers[0].name;
  }
}

TEST(DenseMatchers, RefuseWhatTheyCannotMatch) {
  for (const auto& [label, map_of] : maps()) {
    const auto error_output = [&, &of = map_of](const RectifiedPair& pair,
                                                const DisparityRange& range) {
      const std::string message = test::error_message([&] { of(pair, range); });
      EXPECT_EQ(message.find('\n'), std::string::npos);
      return message;
    };
    EXPECT_NE(error_output({texture(0), texture(0, 200)}, {0, 16})
                  .find("220x60 and the right one 200x60"),
              std::string::npos);
    EXPECT_NE(error_output({}, {0, 16}).find("no pixels"), std::string::npos);
    EXPECT_NE(error_output(plane(9), {5, 4}).find("range 5 to 4"), std::string::npos);
    EXPECT_NE(error_output(plane(9), {0, 220}).find("exceeds the image width of 220"),
              std::string::npos);
    EXPECT_NE(error_output(plane(9), {-220, 0}).find("exceeds"), std::string::npos);
    EXPECT_EQ(error_output(plane(9), {-219, 219}), "");
    EXPECT_NE(error_output({texture(0, 5000), texture(0, 5000)}, {0, 2500}).find("2000 px"),
              std::string::npos);
  }
  const auto bad = [](auto&& change) {
    BmOptions bm_options;
    SgbmOptions sgbm_options;
    change(bm_options, sgbm_options);
    return std::pair(test::error_message([&] {
                       bm_map(plane(9), {0, 16}, bm_options);
                     }),
                     test::error_message([&] {
                       sgbm_map(plane(9), {0, 16}, sgbm_options);
                     }));
  };
  const auto even = bad([](auto& b, auto& s) { b.block_px = s.block_px = 8; });
  EXPECT_NE(even.first.find("bm: its block"), std::string::npos);
  EXPECT_NE(even.second.find("sgbm: its block"), std::string::npos);
  const auto below =
      bad([](auto& b, auto& s) { b.uniqueness_percent = s.uniqueness_percent = -1; });
  EXPECT_NE(below.first.find("uniqueness"), std::string::npos);
  EXPECT_NE(below.second.find("uniqueness"), std::string::npos);
  const auto cap = bad([](auto& b, auto& s) { b.pre_filter_cap = 64, s.p1 = 99, s.p2 = 99; });
  EXPECT_NE(cap.first.find("pre-filter"), std::string::npos);
  EXPECT_NE(cap.second.find("p2 is not above p1"), std::string::npos);
}

TEST(SampleAtEdges, InterpolatesAlongTheRowAndTakesTheForegroundAtAStep) {
  DisparityMap map{60, 9, {}};
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 60; ++x) map.values.push_back(x < 30 ? 0.5f * x : 40.0f);
  }
  map.values[4 * 60 + 50] = std::numeric_limits<float>::quiet_NaN();
  const std::vector<EdgePoint> edges = {test::edge_at(10.3f, 4), test::edge_at(29.2f, 4),
                                        test::edge_at(50, 4), test::edge_at(50.8f, 4)};
  const auto at = sample_at_edges(map, edges);
  EXPECT_NEAR(at[0].disparity_px, 5.15, 1e-5);
  EXPECT_EQ(at[1].disparity_px, 40);
  EXPECT_FALSE(at[2].matched());
  EXPECT_EQ(at[2].confidence, 0);
  EXPECT_EQ(at[3].disparity_px, 40);
  EXPECT_EQ(at[1].own_px, 14.5f);
  EXPECT_EQ(sample_at_edges(map, edges, EdgeSampling::nearest)[1].disparity_px, 14.5f);
  EXPECT_NE(test::error_message([&] {
              sample_at_edges(map, {test::edge_at(60, 4)});
            }).find("disparity map: has 60x9 pixels, but an edge is at (60, 4)"),
            std::string::npos);
}

// A surface has more than one pixel: the speck is itself at its own edge and nothing to the edges
// around it.
TEST(SampleAtEdges, TakesNoSpeckForAForeground) {
  DisparityMap map{60, 9, std::vector<float>(60 * 9, 10)};
  map.values[4 * 60 + 30] = 25;
  const auto at = sample_at_edges(map, {test::edge_at(29, 4), test::edge_at(31, 4),
                                        test::edge_at(30, 3), test::edge_at(30, 4)});
  for (const int beside : {0, 1, 2}) EXPECT_EQ(at[beside].disparity_px, 10) << beside;
  EXPECT_EQ(at[3].disparity_px, 25);
  map.values[4 * 60 + 30] = 2;
  const auto low = sample_at_edges(map, {test::edge_at(30, 4)})[0];
  EXPECT_EQ(low.disparity_px, 10);
  EXPECT_EQ(low.own_px, 2);
}

}  // namespace
}  // namespace vernier
