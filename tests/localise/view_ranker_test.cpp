// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/view_ranker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

#include "calib/statistics/random.h"
#include "localise/place.h"
#include "localise/ranking/coarse_panorama.h"
#include "localise/ranking/panorama.h"
#include "localise/topological_map.h"
#include "tests/support/camera_views.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::localise::internal;

namespace {

constexpr int in_view = 14;

/// Lines all around a place.
std::vector<PlaceLine> around(std::uint64_t seed) {
  std::vector<PlaceLine> lines;
  for (int k = 0; k < 4; ++k) {
    const auto part = test::random_room(4 * seed + k, 60);
    for (const PlaceLine& line : test::seen_from(part, {0, 0, 0.5 * std::numbers::pi * k})) {
      lines.push_back(line);
    }
  }
  return lines;
}

/// Panoramas of a place that was seen at some headings.
std::vector<Panorama> seen_at(std::uint64_t seed, std::initializer_list<double> headings) {
  std::vector<MapNode> nodes;
  for (const double heading : headings) {
    nodes.push_back({{0, 0, heading}, test::camera_view(around(seed), {0, 0, heading})});
  }
  std::vector<const MapNode*> views;
  for (const MapNode& node : nodes) views.push_back(&node);
  return panoramas(views, in_view);
}

const auto all_around = {0.0, 0.8, 1.6, 2.4, 3.1, -2.4, -1.6, -0.8};

/// The fine descriptor of a view compared with one window in plain arithmetic.
double plain_likeness(const std::vector<float>& view, const Panorama& panorama, std::size_t i) {
  double product = 0, norm = 0;
  for (std::size_t k = 0; k < view.size(); ++k) {
    const double bin = panorama.bins[panorama.windows[i].begin * PanoramaBins::channels + k];
    product += view[k] * bin;
    norm += bin * bin;
  }
  return product / std::sqrt(norm);
}

TEST(Panorama, IsComparedInSteps) {
  const Panorama panorama = seen_at(3, all_around)[0];
  ASSERT_EQ(panorama.windows.size(), 64u);
  const auto view = view_descriptor(test::camera_view(around(3), {0.1, 0.2, 0.4}).lines, in_view);
  std::size_t best = 0;
  for (std::size_t i = 0; i < 64; ++i) {
    const Panorama::Window& window = panorama.windows[i];
    const PanoramaMatch match = best_match(view, panorama, window.bearing, 0);
    EXPECT_NEAR(match.likeness, plain_likeness(view, panorama, i), 0.01);
    if (plain_likeness(view, panorama, i) > plain_likeness(view, panorama, best)) best = i;
  }
  // Reach goes around the circle.
  const int opposite = (panorama.windows[best].bearing + 32) % 64;
  EXPECT_EQ(best_match(view, panorama, opposite, 32).likeness,
            best_match(view, panorama, panorama.windows[best].bearing, 0).likeness);
  EXPECT_EQ(best_match(view, Panorama{}, 0, 64).likeness, 0.0f);
}

// Property: what coarse bins leave out cannot look like the view; the rest is rounding.
TEST(CoarsePanoramas, AreNeverLessAlikeThanFineOnes) {
  for (const auto& headings : {all_around, {0.0}, {2.9}, {0.5, 2.5}, {0.0, 3.1}}) {
    const Panorama panorama = seen_at(5, headings)[0];
    CoarsePanoramas coarse;
    coarse.add(panorama);
    for (int k = 0; k < 20; ++k) {
      const auto view =
          view_descriptor(test::camera_view(around(5 + k % 3), {0, 0, 0.3 * k}).lines, in_view);
      for (const CoarseMatch& match : coarse.best(CoarseView(view), 100)) {
        const PanoramaMatch fine = best_match(view, panorama, match.bearing, 0);
        ASSERT_GT(fine.likeness, 0) << "a window that is not known";
        EXPECT_GE(match.likeness, fine.likeness - 0.02f);
        EXPECT_LE(match.likeness, 1.02f);
      }
    }
  }
}

// Oracle: the products as a loop.
TEST(CoarsePanoramas, ProductsAreWhole) {
  RandomStream d({.seed = 8});
  for (const std::size_t bearings : {1, 3, 7, 16}) {
    std::vector<std::int16_t> view((bearings * CoarseBins::channels + 31) / 32 * 32, 0);
    for (std::size_t i = 0; i < bearings * CoarseBins::channels; ++i) {
      view[i] = static_cast<std::int16_t>(d.uniform(0, CoarseView::steps / 16.0));
    }
    std::vector<std::uint8_t> run(view.size() + 9 * CoarseBins::channels + 32);
    for (std::uint8_t& bin : run) bin = static_cast<std::uint8_t>(d.uniform(0, 255.9));
    for (const std::size_t windows : {1, 2, 5, 9}) {
      std::vector<std::int32_t> products(windows);
      coarse_products(view, run.data(), products);
      for (std::size_t w = 0; w < windows; ++w) {
        std::int64_t expected = 0;
        for (std::size_t i = 0; i < view.size(); ++i) {
          expected += std::int64_t{view[i]} * run[w * CoarseBins::channels + i];
        }
        EXPECT_EQ(products[w], expected);
      }
    }
  }
}

// Oracle: the search of all windows of all panoramas. The best pose is missed at most as often as
// 5 of 200 queries in rooms that no constant was chosen on.
// A calibration that is wrong enough has a negative focal length, or looks past its image.
TEST(ViewRanker, AMapOfAnImpossibleRigHasAViewAllTheSame) {
  for (const double f_px : {-300.0, 1e-9, 525.0}) {
    for (const double centre_px : {-1e6, 320.0, 1e6}) {
      PlaceView view = test::camera_view(around(3), {});
      ASSERT_TRUE(view.rig);
      Rig rig = *view.rig;
      for (Camera& camera : rig.cameras) {
        camera.parameters[0] = f_px;
        camera.parameters[2] = centre_px;
      }
      view.rig = std::make_shared<const Rig>(rig);
      TopologicalMap map;
      map.nodes.push_back({{}, view});
      const ViewRanker ranker(map);
      EXPECT_GT(bearings_in_view(map), 0);
      EXPECT_LE(ranker.rank(view, 4).size(), 4u);
    }
  }
}

TEST(ViewRanker, FindsWhatAFullSearchFinds) {
  TopologicalMap map;
  std::vector<std::vector<Panorama>> all;
  constexpr int places = 600;
  for (int i = 0; i < places; ++i) {
    const auto place = seen_at(1000 + i, {0.0, 1.0});
    all.push_back(place);
    for (const double heading : {0.0, 1.0}) {
      map.nodes.push_back(
          {{20.0 * i, 0, heading}, test::camera_view(around(1000 + i), {0, 0, heading})});
    }
  }
  const ViewRanker ranker(map);
  RandomStream d({.seed = 77});
  int missed = 0;
  for (int k = 0; k < 200; ++k) {
    const int truth = static_cast<int>(d.uniform(0, places));
    const PlaceView query = test::camera_view(
        around(1000 + truth), {d.uniform(-0.3, 0.3), d.uniform(-0.3, 0.3), d.uniform(0, 1)});
    const auto view = view_descriptor(query.lines, bearings_in_view(map));
    float best = 0;
    for (const auto& place : all) {
      for (const Panorama& panorama : place) {
        best = std::max(best, best_match(view, panorama, 0, PanoramaBins::bearings).likeness);
      }
    }
    const auto ranked = ranker.rank(query, 16);
    ASSERT_EQ(ranked.size(), 16u);
    EXPECT_LE(ranked[0].score, best + 1e-6);
    missed += ranked[0].score < best - 1e-6;
    EXPECT_TRUE(std::is_sorted(ranked.begin(), ranked.end(),
                               [](const auto& a, const auto& b) { return a.score > b.score; }));
  }
  EXPECT_LE(missed, 5);
  EXPECT_TRUE(ranker.rank(test::view_of({}), 16).empty());
  EXPECT_TRUE(ranker.rank(map.nodes[0].view, 0).empty());
}

}  // namespace
}  // namespace vernier
