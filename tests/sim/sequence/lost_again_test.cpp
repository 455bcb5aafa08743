// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sequence/lost_again.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "sim/sequence/sequence_samples.h"
#include "sim/sources/measured_sources.h"

namespace vernier::sim::internal {
namespace {

constexpr int view_count = 60, line_count = 200;
constexpr double step_m = 0.1;

/// A straight way, on which every view expects every line.
struct Walk {
  std::vector<SequenceView> views{view_count};
  std::vector<int> block;
  std::vector<ExpectedSample> expected;

  explicit Walk(const std::function<bool(int line, int view)>& lost) {
    for (int v = 0; v < view_count; ++v) {
      views[static_cast<std::size_t>(v)].T_world_camera.t = {step_m * v, 0, 0};
      block.push_back(v / 10);
      for (int line = 0; line < line_count; ++line) {
        ExpectedSample s;
        s.at.view = v;
        s.line = line;
        s.found = !lost(line, v);
        expected.push_back(s);
      }
    }
  }
  std::vector<LostAgain> measured() const { return lost_again(expected, views, block, {}); }
};

TEST(LostAgain, IsTheShareWhereLossesAreIndependent) {
  std::mt19937 chance(5);
  std::bernoulli_distribution lost(0.3);
  for (const LostAgain& band : Walk([&](int, int) { return lost(chance); }).measured()) {
    // 12,000 losses: a standard deviation of 0.0042 of what all pairs share; by chance p < 1e-5
    EXPECT_NEAR(band.again.value, 0.3, 0.0042 * 4.5) << band.from_m;
  }
}

TEST(LostAgain, IsOneOfLinesThatNoViewShows) {
  for (const LostAgain& band : Walk([](int line, int) { return line % 3 == 0; }).measured()) {
    EXPECT_EQ(band.again.value, 1) << band.from_m;
  }
}

// Lost in stretches of 0.5 m, every other one, beginning elsewhere for each line: of two views d
// apart 1 - d / 0.5 share a stretch, and views a whole number of metres apart lose alike.
TEST(LostAgain, FallsWithTheDistanceWherePlacesLoseAlike) {
  const auto measured =
      Walk([](int line, int view) { return (view + line) / 5 % 2 == 0; }).measured();
  ASSERT_EQ(measured.size(), 6u);
  EXPECT_EQ(measured[0].from_m, 0);
  EXPECT_TRUE(std::isinf(measured[5].to_m));
  EXPECT_NEAR(measured[0].again.value, (0.8 + 0.6) / 2, 0.02);  // 0.1 and 0.2 m
  EXPECT_NEAR(measured[1].again.value, (0.4 + 0.2) / 2, 0.02);  // 0.3 and 0.4 m
  for (const LostAgain& band : measured) {
    EXPECT_LE(band.again.interval.low, band.again.value);
    EXPECT_GE(band.again.interval.high, band.again.value);
  }
}

// The source's own model: places of 0.6 m along the way, whose draw a line takes with the
// probability of a half. Along one axis grids in any direction share less than those along it, so
// the grid is turned for each line.
TEST(LossesAlike, FindsWhatTheSourceIsMadeOf) {
  constexpr double side_m = 0.6, alike = 0.5, share = 0.4;
  std::mt19937 chance(11);
  std::uniform_real_distribution<double> uniform;
  std::vector<std::vector<bool>> lost;
  for (int line = 0; line < line_count; ++line) {
    const double cosine = std::cos(std::numbers::pi / 2 * uniform(chance));
    const double sine = std::sqrt(1 - cosine * cosine);
    const double x0 = uniform(chance), y0 = uniform(chance);
    std::map<std::pair<int, int>, double> of_place;
    for (int v = 0; v < view_count; ++v) {
      const double at = step_m * v / side_m;
      const std::pair place{int(std::floor(at * cosine + x0)), int(std::floor(at * sine + y0))};
      const double draw = of_place.try_emplace(place, uniform(chance)).first->second;
      const bool by_place = uniform(chance) < std::sqrt(alike);
      lost.resize(line_count);
      lost[static_cast<std::size_t>(line)].push_back((by_place ? draw : uniform(chance)) < share);
    }
  }
  const Walk walk([&](int line, int view) {
    return lost[static_cast<std::size_t>(line)][static_cast<std::size_t>(view)];
  });
  const LossesAlike found = losses_alike(walk.expected, walk.views, walk.block, {});
  EXPECT_NEAR(found.correlation.value, alike, 0.1);
  EXPECT_NEAR(found.side_m.value, side_m, 0.15);
  EXPECT_LE(found.correlation.interval.low, alike);
  EXPECT_GE(found.correlation.interval.high, alike);
}

TEST(LossesAlike, OfIndependentLossesIsNearZero) {
  std::mt19937 chance(6);
  std::bernoulli_distribution lost(0.4);
  const Walk walk([&](int, int) { return lost(chance); });
  EXPECT_LT(losses_alike(walk.expected, walk.views, walk.block, {}).correlation.value, 0.05);
}

TEST(LostAgain, IsNoNumberOfFewerThanThirtyPairs) {
  Walk walk([](int, int) { return true; });
  walk.expected.resize(10);
  for (const LostAgain& band : walk.measured()) EXPECT_TRUE(std::isnan(band.again.value));
}

}  // namespace
}  // namespace vernier::sim::internal
