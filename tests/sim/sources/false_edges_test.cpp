// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "calib/camera.h"
#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "stereo/segment.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::stereo;

namespace {

StereoObservation sense(const SourceSettings& settings,
                        std::uint32_t trial = 0,
                        std::uint32_t frame = 0) {
  return Sensor(test::nominal_rig().rig, settings)
      .sense(test::office_look(), {.seed = 7, .trial = trial, .frame = frame});
}

SourceSettings clutter(double share) {
  SourceSettings settings = no_sources();
  settings.clutter = share;
  return settings;
}

/// Segments by feature, the false ones or the others.
std::map<std::uint32_t, StereoSegment> segments(const StereoObservation& of, bool are_false) {
  std::map<std::uint32_t, StereoSegment> found;
  for (std::size_t i = 0; i < of.segments.size(); ++i) {
    if (of.true_edges[i].is_false() == are_false) found[of.segments[i].feature] = of.segments[i];
  }
  return found;
}

bool equal(const ImageSegment& a, const ImageSegment& b) {
  return a.a_px == b.a_px && a.b_px == b.b_px;
}
bool equal(const StereoSegment& a, const StereoSegment& b) {
  return equal(a.left, b.left) && equal(a.right, b.right);
}

/// Whether all of a's segments are in b, to the bit.
void expect_subset(const std::map<std::uint32_t, StereoSegment>& a,
                   const std::map<std::uint32_t, StereoSegment>& b) {
  for (const auto& [feature, segment] : a) {
    ASSERT_TRUE(b.contains(feature));
    EXPECT_TRUE(equal(segment, b.at(feature)));
  }
}

TEST(Clutter, IsAShareOfTheEdgesInViewAndLeavesThemAlone) {
  const auto visible = static_cast<double>(test::office_look().edges.size());
  const StereoObservation clean = sense(no_sources()), cluttered = sense(clutter(0.5));
  EXPECT_EQ(segments(clean, true).size(), 0u);
  const auto count = static_cast<double>(segments(cluttered, true).size());
  EXPECT_GE(count, std::floor(0.5 * visible));
  EXPECT_LE(count, std::ceil(0.5 * visible));
  const auto before = segments(clean, false), after = segments(cluttered, false);
  EXPECT_EQ(before.size(), after.size());
  expect_subset(before, after);
}

TEST(Clutter, LiesAtTheDepthOfAnEdgeAndIsTheSameMarkInBothEyes) {
  const Rig& rig = test::nominal_rig().rig;
  const StereoObservation cluttered = sense(clutter(2));
  std::vector<double> depths;
  for (const VisibleEdge& edge : test::office_look().edges) {
    depths.push_back(0.5 * (edge.a_m.z() + edge.b_m.z()));
  }
  for (std::size_t i = 0; i < cluttered.segments.size(); ++i) {
    const VisibleEdge& edge = cluttered.true_edges[i];
    if (!edge.is_false()) continue;
    EXPECT_EQ(edge.segment, no_segment);
    EXPECT_EQ(edge.object, 0);
    double nearest = 1e9;
    for (const double depth : depths) nearest = std::min(nearest, std::abs(depth - edge.a_m.z()));
    EXPECT_LT(nearest, 1e-9);
    EXPECT_NEAR(edge.a_m.z(), edge.b_m.z(), 1e-9);
    const StereoSegment& s = cluttered.segments[i];
    EXPECT_GE(s.left.length_px(), 10 - 1e-6);
    EXPECT_LE(s.left.length_px(), 100 + 1e-6);
    for (int eye = 0; eye < 2; ++eye) {
      const ImageSegment& seen = eye == 0 ? s.left : s.right;
      const Eigen::Vector3d a = rig.T_camera_first[eye] * edge.a_m;
      EXPECT_LT((project(rig.cameras[eye], a) - seen.a_px).norm(), 1e-6);
      for (const Eigen::Vector2d& end : {seen.a_px, seen.b_px}) {
        for (int k = 0; k < 2; ++k) {
          EXPECT_GE(end[k], -0.5 - 1e-6);
          EXPECT_LE(end[k], rig.cameras[eye].size_px[k] - 0.5 + 1e-6);
        }
      }
    }
  }
}

TEST(Clutter, IsOfOneLookAndALargerShareHoldsTheSmallerOne) {
  const auto few = segments(sense(clutter(0.2)), true), many = segments(sense(clutter(1.3)), true);
  EXPECT_GT(few.size(), 10u);
  EXPECT_GT(many.size(), 4 * few.size());
  expect_subset(few, many);
  for (const auto& other : {sense(clutter(0.2), 1, 0), sense(clutter(0.2), 0, 1)}) {
    for (const auto& [feature, segment] : segments(other, true)) {
      if (few.contains(feature)) {
        EXPECT_FALSE(equal(segment, few.at(feature)));
      }
    }
  }
}

/// Later sources act on false edges, and give every other edge what they give it without.
TEST(Clutter, PassesThroughTheLaterSources) {
  SourceSettings settings;  // all of the memo's
  const StereoObservation without = sense(settings);
  settings.clutter = 0.5;
  const StereoObservation with = sense(settings);
  const auto before = segments(without, false), after = segments(with, false);
  EXPECT_EQ(before.size(), after.size());
  expect_subset(before, after);
  const auto exact = segments(sense(clutter(0.5)), true);
  int cut = 0, same = 0;
  std::set<double> shifts;
  for (const auto& [feature, segment] : segments(with, true)) {
    cut += feature % 2;
    if (!exact.contains(feature)) continue;
    same += equal(segment, exact.at(feature));
    shifts.insert((segment.left.a_px - exact.at(feature).left.a_px).norm());
  }
  EXPECT_GT(cut, 0);
  EXPECT_EQ(same, 0);
  EXPECT_GT(shifts.size(), 10u);  // each has its own
}

TEST(Clutter, NeedsSomethingToBeSeen) {
  NoiseFreeView nothing;
  EXPECT_TRUE(Sensor(test::nominal_rig().rig, clutter(5)).sense(nothing, {}).segments.empty());
}

/// A frontoparallel edge whose left image runs between two pixels, at a depth.
VisibleEdge edge_at(double u0, double v0, double u1, double v1, std::uint32_t feature) {
  const Camera& left = test::nominal_rig().rig.cameras[0];
  VisibleEdge edge;
  edge.a_m = 3 * unproject(left, {u0, v0});
  edge.b_m = 3 * unproject(left, {u1, v1});
  edge.segment = static_cast<int>(feature);
  edge.feature = feature;
  edge.object_centre_m.setZero();
  return edge;
}

StereoObservation merged(const std::vector<VisibleEdge>& edges, double merge_px) {
  SourceSettings settings = no_sources();
  settings.merge_px = merge_px;
  NoiseFreeView seen;
  seen.edges = edges;
  return Sensor(test::nominal_rig().rig, settings).sense(seen, {});
}

TEST(LineMerging, MakesOneOfTwoCloseParallelLines) {
  // 60 and 30 px long, 2 px apart: at the mean weighted by length, 2/3 px from the longer one.
  const StereoObservation one =
      merged({edge_at(302, 220, 302, 250, 5), edge_at(300, 200, 300, 260, 9)}, 3);
  ASSERT_EQ(one.segments.size(), 1u);
  EXPECT_EQ(one.segments[0].feature, 18u);
  EXPECT_NEAR(one.segments[0].left.a_px.x(), 300 + 2.0 / 3, 1e-6);
  EXPECT_NEAR(one.segments[0].left.b_px.x(), 300 + 2.0 / 3, 1e-6);
  EXPECT_NEAR(one.segments[0].left.a_px.y(), 200, 1e-6);
  EXPECT_NEAR(one.segments[0].left.b_px.y(), 260, 1e-6);
  // Both at one depth: as far in the right eye.
  const StereoObservation alone = merged({edge_at(300, 200, 300, 260, 9)}, 3);
  EXPECT_NEAR(one.segments[0].right.a_px.x() - alone.segments[0].right.a_px.x(), 2.0 / 3, 0.02);
}

TEST(LineMerging, DoesNotDependOnTheOrderOrDirection) {
  const auto a = merged({edge_at(302, 220, 302, 250, 5), edge_at(300, 200, 300, 260, 9)}, 3),
             b = merged({edge_at(300, 200, 300, 260, 9), edge_at(302, 220, 302, 250, 5)}, 3),
             c = merged({edge_at(300, 200, 300, 260, 9), edge_at(302, 250, 302, 220, 5)}, 3);
  ASSERT_EQ(b.segments.size(), 1u);
  ASSERT_EQ(c.segments.size(), 1u);
  EXPECT_TRUE(equal(a.segments[0], b.segments[0]));
  EXPECT_LT((a.segments[0].right.a_px - c.segments[0].right.a_px).norm(), 1e-9);
}

TEST(LineMerging, LeavesLinesThatAreApart) {
  const VisibleEdge line = edge_at(300, 200, 300, 260, 9);
  const auto stay = [&](const VisibleEdge& other) {
    return merged({line, other}, 3).segments.size() == 2;
  };
  EXPECT_TRUE(stay(edge_at(304, 200, 304, 250, 5)));   // farther than 3 px
  EXPECT_TRUE(stay(edge_at(301, 250, 301, 300, 5)));   // a fifth beside it
  EXPECT_TRUE(stay(edge_at(298, 220, 302, 250, 5)));   // 7.6 degrees
  EXPECT_FALSE(stay(edge_at(299, 220, 301, 250, 5)));  // 3.8 degrees
  EXPECT_FALSE(stay(edge_at(301, 240, 301, 280, 5)));  // half of it beside it
}

TEST(LineMerging, TakesTheLongestOfSeveralAndLeavesOtherDraws) {
  const auto three = merged({edge_at(302, 200, 302, 240, 1), edge_at(300, 200, 300, 260, 2),
                             edge_at(298, 200, 298, 220, 3)},
                            3);
  ASSERT_EQ(three.segments.size(), 1u);
  EXPECT_EQ(three.segments[0].feature, 4u);
  EXPECT_NEAR(three.segments[0].left.a_px.x(), 300 + (2 * 40 - 2 * 20) / 120.0, 1e-6);

  SourceSettings settings = no_sources();
  settings.endpoint_sigma_px = 0.15;
  const auto before = segments(sense(settings), false);
  settings.merge_px = 2;
  SourceSettings only_merging = no_sources();
  only_merging.merge_px = 2;
  const auto after = segments(sense(settings), false), moved = segments(sense(only_merging), false);
  const auto exact = segments(sense(no_sources()), false);
  EXPECT_LT(after.size(), before.size());
  EXPECT_GT(after.size(), before.size() / 2);
  for (const auto& [feature, segment] : after) {
    const Eigen::Vector2d noise = segment.left.a_px - moved.at(feature).left.a_px;
    EXPECT_LT((noise - (before.at(feature).left.a_px - exact.at(feature).left.a_px)).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace vernier
