// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <set>

#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "stereo/segment.h"
#include "tests/support/small_office.h"

namespace vernier::test {
namespace {

StereoObservation seen_with(SourceSettings settings,
                            double unseen,
                            std::uint64_t seed = 7,
                            std::uint32_t trial = 0) {
  settings.unseen = unseen;
  return Sensor(nominal_rig().rig, settings).sense(office_look(), {.seed = seed, .trial = trial});
}

std::map<std::uint32_t, Eigen::Vector4d> lefts(const StereoObservation& seen) {
  std::map<std::uint32_t, Eigen::Vector4d> lines;
  for (const stereo::StereoSegment& s : seen.segments) {
    lines[s.feature] << s.left.a_px, s.left.b_px;
  }
  return lines;
}

TEST(UnseenEdges, AreTheSameInAllTrialsAndNestedByShare) {
  std::set<std::uint32_t> last;
  for (const double share : {0.7, 0.3, 0.0}) {
    std::set<std::uint32_t> features;
    for (const auto& [feature, line] : lefts(seen_with(no_sources(), share)))
      features.insert(feature);
    for (const std::uint32_t trial : {1U, 99U}) {
      std::set<std::uint32_t> again;
      for (const auto& [feature, line] : lefts(seen_with(no_sources(), share, 7, trial))) {
        again.insert(feature);
      }
      EXPECT_EQ(again, features);
    }
    for (const std::uint32_t feature : last) EXPECT_TRUE(features.contains(feature));
    EXPECT_GT(features.size(), last.size());
    last = features;
  }
  EXPECT_TRUE(seen_with(no_sources(), 1).segments.empty());
}

TEST(UnseenEdges, LeaveTheOthersAsTheyAre) {
  const auto all = lefts(seen_with({}, 0)), fewer = lefts(seen_with({}, 0.4));
  ASSERT_FALSE(fewer.empty());
  EXPECT_LT(fewer.size(), all.size());
  for (const auto& [feature, line] : fewer) {
    ASSERT_TRUE(all.contains(feature));
    EXPECT_EQ(line, all.at(feature));
  }
}

// Each tail fails by chance with a probability of 1e-5.
TEST(UnseenEdges, HaveTheirShareOverSeeds) {
  std::set<int> segments;
  for (const VisibleEdge& edge : office_look().edges) segments.insert(edge.segment);
  constexpr int seeds = 200;
  constexpr double share = 0.3;
  int kept = 0;
  const auto all = lefts(seen_with(no_sources(), 0)).size();
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    kept += static_cast<int>(lefts(seen_with(no_sources(), share, seed)).size());
  }
  // Parts of one segment go together, so the trials are fewer than the features.
  const double mean = 1.0 - double(kept) / (double(seeds) * static_cast<double>(all));
  const double n = seeds * static_cast<double>(segments.size());
  const double most_parts = double(all) / static_cast<double>(segments.size());
  const double z = (mean - share) / std::sqrt(share * (1 - share) * 2 * most_parts / n);
  EXPECT_LT(std::abs(z), 4.27);
}

}  // namespace
}  // namespace vernier::test
