// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "stereo/segment.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;

namespace {

constexpr double SourceSettings::*edge_sources[] = {
    &SourceSettings::clutter,           &SourceSettings::lateral_shift_px,
    &SourceSettings::merge_px,          &SourceSettings::edge_loss,
    &SourceSettings::endpoint_sigma_px, &SourceSettings::stereo_mismatch};
constexpr double sizes[] = {0.4, 3, 1.5, 0.1125, 0.15, 0.2};
constexpr unsigned subsets = 1u << std::size(edge_sources);

SourceSettings subset(unsigned which) {
  SourceSettings settings = no_sources();
  for (std::size_t i = 0; i < std::size(edge_sources); ++i) {
    if (which >> i & 1) settings.*edge_sources[i] = sizes[i];
  }
  return settings;
}

using Ends = Eigen::Matrix<double, 8, 1>;

std::map<std::uint32_t, Ends> ends_of(const SourceSettings& settings) {
  const StereoObservation seen =
      Sensor(test::nominal_rig().rig, settings).sense(test::office_look(), {.seed = 7, .trial = 2});
  std::map<std::uint32_t, Ends> ends;
  for (const stereo::StereoSegment& s : seen.segments) {
    ends[s.feature] << s.left.a_px, s.left.b_px, s.right.a_px, s.right.b_px;
  }
  return ends;
}

/// What the end-point error adds to each edge is the same whatever subset of the others acts, and
/// so is which edges are mismatched and by how much: all 32 subsets of the others.
TEST(SourceIndependence, OfTheEndpointErrorFromEverySubset) {
  constexpr unsigned bit = 1u << 4;
  std::map<std::uint32_t, Ends> error;  // by feature, from the first subset that has it
  std::size_t compared = 0;
  for (unsigned which = 0; which < subsets; ++which) {
    if (which & bit) continue;
    const auto without = ends_of(subset(which)), with = ends_of(subset(which | bit));
    // Without a wrong partner, whose slip along the epipolar line depends on the row.
    ASSERT_EQ(without.size(), with.size());
    for (const auto& [feature, ends] : with) {
      const Ends added = ends - without.at(feature);
      const auto [known, is_new] = error.emplace(feature, added);
      if (is_new) continue;
      EXPECT_LT((added - known->second).norm(), 0.02) << "subset " << which;
      EXPECT_LT((added - known->second).head<4>().norm(), 1e-9) << "subset " << which;
      ++compared;
    }
  }
  EXPECT_GT(compared, 31 * error.size() / 2);
}

TEST(SourceIndependence, OfMismatchesFromEverySubset) {
  constexpr unsigned bit = 1u << 5;
  std::map<std::uint32_t, double> slip;
  std::size_t compared = 0, moved = 0;
  for (unsigned which = 0; which < subsets; ++which) {
    if (which & bit) continue;
    const auto without = ends_of(subset(which)), with = ends_of(subset(which | bit));
    ASSERT_EQ(without.size(), with.size());
    for (const auto& [feature, ends] : with) {
      const Ends added = ends - without.at(feature);
      EXPECT_EQ(added.head<4>().norm(), 0);
      const auto [known, is_new] = slip.emplace(feature, added[4]);
      moved += added[4] != 0;
      if (is_new) continue;
      EXPECT_EQ(added[4] == 0, known->second == 0);
      EXPECT_NEAR(added[4], known->second, 0.2);  // distortion differs from place to place
      ++compared;
    }
  }
  EXPECT_GT(compared, 31 * slip.size() / 2);
  EXPECT_GT(moved, compared / 10);
}

/// False edges are the same whatever acts on them later.
TEST(SourceIndependence, OfClutterFromLaterSources) {
  const auto alone = ends_of(subset(1));
  const auto without = ends_of(subset(0));
  SourceSettings with_mount = subset(1);
  with_mount.mount_height_m = 0.1;  // acts on poses, not here
  with_mount.moved = 0.5;
  EXPECT_EQ(ends_of(with_mount), alone);
  for (const auto& [feature, ends] : without) EXPECT_EQ(alone.at(feature), ends);
}

/// Everything together, in 1, 2 and 8 threads that share a sensor.
TEST(SourceIndependence, OfThreads) {
  SourceSettings settings;
  settings.clutter = 0.4;
  settings.merge_px = 1.5;
  const Sensor sensor(test::nominal_rig().rig, settings);
  constexpr std::uint32_t trials = 32;
  const auto all = [&](std::uint32_t threads) {
    std::vector<StereoObservation> seen(trials);
    std::vector<std::thread> running;
    for (std::uint32_t t = 0; t < threads; ++t) {
      running.emplace_back([&, t] {
        for (std::uint32_t i = t; i < trials; i += threads) {
          seen[i] = sensor.sense(test::office_look(), {.seed = 7, .trial = i});
        }
      });
    }
    for (std::thread& thread : running) thread.join();
    return seen;
  };
  const auto one = all(1);
  for (const std::uint32_t threads : {2u, 8u}) {
    const auto many = all(threads);
    for (std::uint32_t i = 0; i < trials; ++i) {
      ASSERT_EQ(one[i].segments.size(), many[i].segments.size());
      for (std::size_t k = 0; k < one[i].segments.size(); ++k) {
        EXPECT_EQ(one[i].segments[k].feature, many[i].segments[k].feature);
        EXPECT_EQ(one[i].segments[k].left.a_px, many[i].segments[k].left.a_px);
        EXPECT_EQ(one[i].segments[k].right.b_px, many[i].segments[k].right.b_px);
      }
    }
  }
}

}  // namespace
}  // namespace vernier
