// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <set>

#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "tests/support/small_office.h"

namespace vernier::test {
namespace {

using Features = std::set<std::uint32_t>;

Features seen_with(SourceSettings settings, double missed, std::uint32_t trial) {
  settings.missed = missed;
  const StereoObservation seen =
      Sensor(nominal_rig().rig, settings).sense(office_look(), {.seed = 7, .trial = trial});
  Features features;
  for (const stereo::StereoSegment& s : seen.segments) features.insert(s.feature);
  return features;
}

TEST(MissedEdges, ALargerShareMissesASuperset) {
  for (const std::uint32_t trial : {0U, 99U}) {
    Features fewer = seen_with({}, 0.7, trial);
    for (const double share : {0.3, 0.0}) {
      const Features more = seen_with({}, share, trial);
      EXPECT_TRUE(std::includes(more.begin(), more.end(), fewer.begin(), fewer.end()));
      EXPECT_GT(more.size(), fewer.size());
      fewer = more;
    }
  }
  EXPECT_TRUE(seen_with({}, 1, 0).empty());
}

// Trials miss edges independently of each other, each with its share: over all pairs of trials of
// 200, the shares of edges missed once and twice. Each tail by chance with p of 1e-5.
TEST(MissedEdges, EachViewMissesOthers) {
  constexpr double share = 0.3;
  constexpr int trials = 400;
  const Features all = seen_with(no_sources(), 0, 0);
  double once = 0, twice = 0;
  Features last;
  for (int trial = 0; trial < trials; ++trial) {
    const Features seen = seen_with(no_sources(), share, static_cast<std::uint32_t>(trial));
    once += static_cast<double>(all.size() - seen.size());
    if (trial % 2 == 1) {
      for (const std::uint32_t feature : all)
        twice += !seen.contains(feature) && !last.contains(feature);
    }
    last = seen;
  }
  const double n = static_cast<double>(all.size()) * trials;
  const auto z = [](double count, double of, double p) {
    return (count - of * p) / std::sqrt(of * p * (1 - p));
  };
  EXPECT_LT(std::abs(z(once, n, share)), 4.27);
  EXPECT_LT(std::abs(z(twice, n / 2, share * share)), 4.27);
}

TEST(MissedEdges, LooksOfOneTrialMissOthers) {
  SourceSettings settings = no_sources();
  settings.missed = 0.3;
  const Sensor sensor(nominal_rig().rig, settings);
  std::set<Features> different;
  for (const std::uint32_t frame : {0U, 1U, 2U}) {
    Features features;
    for (const auto& s :
         sensor.sense(office_look(), {.seed = 7, .trial = 1, .frame = frame}).segments) {
      features.insert(s.feature);
    }
    different.insert(features);
  }
  EXPECT_EQ(different.size(), 3u);
}

/// Which features of the office's look are seen from a place on the floor.
Features seen_from(double x_m, double alike, std::uint32_t trial, double missed = 0.4) {
  SourceSettings settings = no_sources();
  settings.missed = missed;
  settings.missed_alike = alike;
  settings.missed_alike_m = 1;
  NoiseFreeView look = office_look();
  look.pose.x_m += x_m;  // what is missed depends on it, and nothing else
  Features features;
  for (const auto& s :
       Sensor(nominal_rig().rig, settings).sense(look, {.seed = 7, .trial = trial}).segments) {
    features.insert(s.feature);
  }
  return features;
}

TEST(MissedEdges, ALargerShareMissesASupersetOfWhatAPlaceMisses) {
  for (const std::uint32_t trial : {0U, 99U}) {
    const Features few = seen_from(0.2, 0.5, trial, 0.6), many = seen_from(0.2, 0.5, trial, 0.2);
    EXPECT_TRUE(std::includes(many.begin(), many.end(), few.begin(), few.end()));
    EXPECT_GT(many.size(), few.size());
  }
}

TEST(MissedEdges, PlacesThatMissAllAlikeDoSoInEveryTrial) {
  EXPECT_EQ(seen_from(0.2, 1, 0), seen_from(0.2, 1, 99));
  EXPECT_NE(seen_from(0.2, 0, 0), seen_from(0.2, 0, 99));
  EXPECT_NE(seen_from(0.2, 1, 0), seen_from(5.2, 1, 0));
}

// The share at every place, and the correlation of two trials d apart: c times the share of grids
// of side 1, in any direction, that have both in one cell, 1 - 4 d / pi + d^2 / pi. Seeds are
// places far apart; each bound by chance with p below 1e-5.
TEST(MissedEdges, CorrelateByDistance) {
  constexpr double share = 0.4, alike = 0.5;
  constexpr int places = 1500;
  const Features all = seen_from(0, alike, 0, 0);
  const double n = static_cast<double>(all.size()) * places;
  for (const double d : {0.0, 0.25, 0.6, 3.0}) {
    double first = 0, both = 0;
    for (std::uint32_t place = 0; place < places; ++place) {
      const Features a = seen_from(100.0 * place, alike, 2 * place),
                     b = seen_from(100.0 * place + d, alike, 2 * place + 1);
      for (const std::uint32_t f : all) {
        first += !a.contains(f);
        both += !a.contains(f) && !b.contains(f);
      }
    }
    const double same = d < 1 ? 1 - 4 * d / std::numbers::pi + d * d / std::numbers::pi : 0;
    const double p = share * share + share * (1 - share) * alike * same;
    // Parts of one segment share the draw of the place: twice the variance at most.
    EXPECT_NEAR(first / n, share, 4.42 * std::sqrt(2 * share * (1 - share) / n)) << d;
    EXPECT_NEAR(both / n, p, 4.42 * std::sqrt(2 * p * (1 - p) / n)) << d;
  }
}

}  // namespace
}  // namespace vernier::test
