// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
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

}  // namespace
}  // namespace vernier::test
