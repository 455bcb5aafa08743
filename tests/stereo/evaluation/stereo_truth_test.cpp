// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/stereo_truth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/statistics/random.h"
#include "stereo/disparity_file.h"
#include "stereo/evaluation/stereo_scenes.h"
#include "tests/support/edge_at.h"
#include "tests/support/error_message.h"
#include "tests/support/foreign_files.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

constexpr int truth_width = 400, truth_height = 3;
constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

/// A strip of a plane: disparity d + g x at the left x in [from, to], there in both images whether
/// something hides it or not.
struct Strip {
  double from = 0, to = 0, d = 0, g = 0;

  double at_left(double x) const { return x >= from && x <= to ? d + g * x : -1; }
  double left_of(double right) const { return (right + d) / (1 - g); }
  double at_right(double right) const { return at_left(left_of(right)); }
  /// Distance in the right image from the strip's ends.
  double from_end(double right) const {
    return std::min(std::abs(right - from + at_left(from)), std::abs(right - to + at_left(to)));
  }
};

using Strips = std::vector<Strip>;

template <typename Disparity>
double nearest(const Strips& strips, const Disparity& disparity) {
  double most = -1;
  for (const Strip& strip : strips) most = std::max(most, disparity(strip));
  return most;
}

/// What one eye sees of the strips.
DisparityMap seen(const Strips& strips, bool in_left, double step = 0) {
  DisparityMap map{truth_width, truth_height,
                   std::vector<float>(truth_width * truth_height, unknown)};
  for (int i = 0; i < truth_width * truth_height; ++i) {
    const double x = i % truth_width;
    double d =
        nearest(strips, [&](const Strip& s) { return in_left ? s.at_left(x) : s.at_right(x); });
    if (step > 0) d = std::round(d / step) * step;
    if (d >= 0) map.values[static_cast<std::size_t>(i)] = static_cast<float>(d);
  }
  return map;
}

/// Left pixels of which the truth says otherwise than the geometry, those within 1.5 px of a
/// strip's end in the right image left out, and how many were judged hidden and seen.
struct Tally {
  int hidden = 0, visible = 0, wrong = 0;
};

Tally compare(const Strips& strips, const StereoTruth& truth) {
  Tally tally;
  for (int x = 0; x < truth_width; ++x) {
    const double d = nearest(strips, [&](const Strip& s) { return s.at_left(x); });
    const double right = x - d;
    const bool at_end = std::any_of(strips.begin(), strips.end(),
                                    [&](const Strip& s) { return s.from_end(right) < 1.5; });
    if (d < 0 || at_end || std::abs(right) < 1.5) continue;
    const bool hidden =
        right < 0 || nearest(strips, [&](const Strip& s) { return s.at_right(right); }) > d + 1e-6;
    (hidden ? tally.hidden : tally.visible) += 1;
    tally.wrong += hidden != (truth.occluded[static_cast<std::size_t>(x)] != 0);
  }
  return tally;
}

/// A background of a random slope and strips in front of it, all of disparities above 0.
Strips random_strips(std::uint32_t trial, int in_front) {
  RandomStream draws({.seed = 61, .trial = trial, .source = 200});
  Strips strips = {{0, truth_width - 1, 0, draws.uniform(-0.3, 0.3)}};
  strips[0].d = 10 + std::max(0.0, -strips[0].g * truth_width);
  for (int i = 0; i < in_front; ++i) {
    const double from = draws.uniform(20, truth_width - 120), to = from + draws.uniform(4, 90);
    Strip strip{from, to, 0, draws.uniform(-0.86, 0.86)};
    const double behind = std::max(strips[0].at_left(from), strips[0].at_left(to));
    strip.d = behind + draws.uniform(3, 30) - std::min(strip.g * from, strip.g * to);
    strips.push_back(strip);
  }
  return strips;
}

TEST(StereoTruth, HidesWhatANearerStripCovers) {
  Tally all;
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    const Strips strips = random_strips(trial, 1);
    const Tally tally = compare(strips, stereo_truth(seen(strips, true)));
    EXPECT_EQ(tally.wrong, 0) << trial;
    all.hidden += tally.hidden;
    all.visible += tally.visible;
  }
  EXPECT_GT(all.hidden, 4000);
  EXPECT_GT(all.visible, 60000);
}

/// A strip that the left eye does not see may hide something from the right one: only the right
/// image's truth knows.
TEST(StereoTruth, HidesWhatTheRightTruthSaysToo) {
  int without = 0;
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    const Strips strips = random_strips(trial, 4);
    const DisparityMap right = seen(strips, false);
    const Tally tally = compare(strips, stereo_truth(seen(strips, true), &right));
    EXPECT_EQ(tally.wrong, 0) << trial;
    without += compare(strips, stereo_truth(seen(strips, true))).wrong;
  }
  EXPECT_GT(without, 100);
}

/// Several left pixels of such a plane fall on one right pixel, with disparities pixels apart.
TEST(StereoTruth, HidesNothingOfASlantedPlane) {
  for (const double gradient : {0.5, 0.67, 0.86, -0.86}) {
    for (const double step : {0.0, 0.125, 0.25}) {
      const Strips plane = {{0, truth_width - 1, gradient < 0 ? 344.0 : 0.0, gradient}};
      const DisparityMap right = seen(plane, false, step);
      for (const DisparityMap* given : {static_cast<const DisparityMap*>(nullptr), &right}) {
        EXPECT_EQ(compare(plane, stereo_truth(seen(plane, true, step), given)).wrong, 0)
            << gradient << " " << step << " " << (given != nullptr);
      }
    }
  }
}

TruthAtEdge truth_of(const StereoTruth& truth, float row_x, int y) {
  return truth_at(truth, {test::edge_at(row_x, y)}).at(0);
}

TEST(TruthAtEdge, IsThatOfTheSubpixelEdgeOnASlantedPlane) {
  DisparityMap map{40, 30, {}};
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) map.values.push_back(0.5f + 0.6f * x + 0.1f * y);
  }
  const StereoTruth truth = stereo_truth(map);
  for (const float x : {12.0f, 12.3f, 12.5f, 12.9f, 38.9f, 39.0f, 39.4f}) {
    for (const int y : {0, 7, 29}) {
      const TruthAtEdge at = truth_of(truth, x, y);
      EXPECT_NEAR(at.disparity_px, 0.5f + 0.6f * std::min(x, 39.0f) + 0.1f * y, 1e-4);
      EXPECT_TRUE(at.known);
      EXPECT_FALSE(at.discontinuity);
      EXPECT_FALSE(at.occluded);
      if (y == 7 && x < 38) {
        EXPECT_NEAR(at.min_px, 0.5f + 0.6f * (std::round(x) - 1) + 0.1f * 6, 1e-4);
        EXPECT_NEAR(at.max_px, 0.5f + 0.6f * (std::round(x) + 1) + 0.1f * 8, 1e-4);
      }
    }
  }
}

/// A near strip of disparity 20, columns 60 to 79, before a far one of 8: the 12 columns left of
/// the strip are occluded.
TEST(TruthAtEdge, IsTheForegroundsAtAStep) {
  DisparityMap map{120, 9, std::vector<float>(120 * 9, 8)};
  for (int y = 0; y < 9; ++y) {
    for (int x = 60; x < 80; ++x) map.values[static_cast<std::size_t>(y * 120 + x)] = 20;
  }
  const StereoTruth truth = stereo_truth(map);
  for (const float x : {59.0f, 59.4f, 60.0f, 79.0f, 80.4f}) {
    const TruthAtEdge at = truth_of(truth, x, 4);
    EXPECT_EQ(at.disparity_px, 20) << x;
    EXPECT_EQ(at.min_px, 8);
    EXPECT_TRUE(at.discontinuity);
    EXPECT_FALSE(at.occluded) << x;
  }
  for (const float x : {58.0f, 81.0f}) {  // two pixels from the step
    EXPECT_EQ(truth_of(truth, x, 4).disparity_px, 8);
    EXPECT_TRUE(truth_of(truth, x, 4).discontinuity);
  }
  for (const float x : {57.0f, 62.0f, 82.0f}) EXPECT_FALSE(truth_of(truth, x, 4).discontinuity);
  EXPECT_TRUE(truth_of(truth, 58, 4).occluded);
  EXPECT_TRUE(truth_of(truth, 49, 4).occluded);
  EXPECT_FALSE(truth_of(truth, 46, 4).occluded);
  EXPECT_FALSE(truth_of(truth, 82, 4).occluded);
  EXPECT_TRUE(truth_of(truth, 5, 4).occluded);  // beyond the right image's border
  EXPECT_FALSE(truth_of(truth, 9, 4).occluded);
}

/// Separate points of two planes, as a laser scanner gives them.
TEST(TruthAtEdge, OfSeparatePointsHasDiscontinuitiesAtStepsOnly) {
  DisparityMap map{120, 40, std::vector<float>(120 * 40, unknown)};
  for (int y = 0; y < 40; ++y) {
    for (int x = (y * 7) % 3; x < 120; x += 3) {
      map.values[static_cast<std::size_t>(y * 120 + x)] = x < 60 ? 8 : 20;
    }
  }
  const StereoTruth truth = stereo_truth(map);
  EXPECT_TRUE(truth.sparse);
  int smooth = 0;
  for (int y = 0; y < 40; ++y) {
    for (int x = 25; x < 116; ++x) {
      const TruthAtEdge at = truth_of(truth, static_cast<float>(x), y);
      EXPECT_EQ(at.known, map.known(x, y));
      const bool is_beside = x == 59 || x == 60;
      if (is_beside || x < 57 || x > 62) {
        EXPECT_EQ(at.discontinuity, is_beside) << x << " " << y;
      }
      smooth += at.known && !at.discontinuity;
    }
  }
  EXPECT_GT(smooth, 1000);
}

TEST(TruthAtEdge, KnowsWhereNothingIsKnown) {
  DisparityMap map{50, 9, std::vector<float>(50 * 9, 8)};
  const auto set = [&](int x, float d) {
    for (int y = 0; y < 9; ++y) map.values[static_cast<std::size_t>(y * 50 + x)] = d;
  };
  for (int x = 20; x < 30; ++x) set(x, unknown);
  for (int x = 41; x < 50; ++x) set(x, 12);
  set(40, unknown);  // a step across a pixel that is not known
  const StereoTruth truth = stereo_truth(map);
  const TruthAtEdge none = truth_of(truth, 25, 4);
  EXPECT_FALSE(none.known);
  EXPECT_TRUE(std::isnan(none.disparity_px) && std::isnan(none.min_px));
  const TruthAtEdge beside = truth_of(truth, 19.4f, 4);
  EXPECT_TRUE(beside.known && beside.discontinuity);
  EXPECT_EQ(beside.disparity_px, 8);
  EXPECT_FALSE(truth_of(truth, 18.4f, 4).discontinuity);
  const TruthAtEdge gap = truth_of(truth, 40.6f, 4);
  EXPECT_EQ(gap.disparity_px, 12);
  EXPECT_TRUE(gap.discontinuity);
  EXPECT_TRUE(truth_of(truth, 39, 4).discontinuity);
}

TEST(StereoTruthOfFiles, IsRefusedWithTheFileNamed) {
  const test::Folder folder;
  const DisparityMap map{4, 3, std::vector<float>(12, 1.5f)};
  StereoSceneFile scene;
  scene.truth = folder.path() / "left.pfm";
  write_disparity(scene.truth, map);
  EXPECT_EQ(read_stereo_truth(scene, 4, 3).disparity.values, map.values);
  const auto error_output = [&](int w, int h) {
    return test::error_message([&] { read_stereo_truth(scene, w, h); });
  };
  EXPECT_NE(error_output(5, 3).find("left.pfm: the size 4x3 differs from that of the images, 5x3"),
            std::string::npos);
  scene.right_truth = folder.path() / "right.pfm";
  write_disparity(scene.right_truth, {3, 4, map.values});
  EXPECT_NE(error_output(4, 3).find("right.pfm: the size 3x4"), std::string::npos);
  write_disparity(scene.right_truth, {4, 3, std::vector<float>(12, unknown)});
  EXPECT_NE(error_output(4, 3).find("right.pfm: has no known disparity"), std::string::npos);
  EXPECT_NE(test::error_message([&] {
              truth_at(stereo_truth(map), {test::edge_at(4, 0)});
            }).find("4x3 pixels, but an edge is at (4, 0)"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
