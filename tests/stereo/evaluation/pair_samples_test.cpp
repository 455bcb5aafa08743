// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Samples of whole images: rendered pairs whose edges are displaced or erased by known amounts. All
// seeds are fixed and each test is of one drawing.
#include "stereo/evaluation/pair_samples.h"

#include <gtest/gtest.h>

#include "calib/statistics/random.h"
#include "stereo/disparity_file.h"
#include "stereo/edge_matcher.h"
#include "stereo/evaluation/corner_repeatability.h"
#include "stereo/evaluation/edge_loss.h"
#include "stereo/evaluation/end_difference.h"
#include "stereo/evaluation/line_match.h"
#include "stereo/evaluation/segment_shift.h"
#include "stereo/grey_levels.h"
#include "stereo/stereo_truth.h"
#include "tests/support/edge_images.h"
#include "tests/support/error_message.h"
#include "tests/support/leaf_pair.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

constexpr int cell = 150, columns = 4, rows = 3, disparity = 20;
constexpr int pair_width = columns * cell + 40, pair_height = rows * cell;

/// Polygons, each growing in the right image by an amount of its own.
struct GrowingPolygons {
  explicit GrowingPolygons(double size_px) {
    RandomStream draws({.seed = 41});
    for (int k = 0; k < columns * rows; ++k) {
      const Eigen::Vector2d centre(40 + (k % columns + 0.5) * cell, (k / columns + 0.5) * cell);
      polygons.push_back(test::random_polygon(centre, draws));
      bright.push_back(draws.uniform() < 0.5);
      growth_px.push_back(size_px * draws.uniform(0.5, 1.5) * (draws.uniform() < 0.5 ? -1 : 1));
    }
  }

  double level(const Eigen::Vector2d& left_px, bool grown) const {
    const int column = std::clamp(static_cast<int>((left_px.x() - 40) / cell), 0, columns - 1);
    const int row = std::clamp(static_cast<int>(left_px.y() / cell), 0, rows - 1);
    const auto k = static_cast<std::size_t>(row * columns + column);
    const auto& corners = polygons[k].corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d side = (corners[(i + 1) % corners.size()] - corners[i]).normalized();
      const Eigen::Vector2d to = left_px - corners[i];
      const double inside = side.x() * to.y() - side.y() * to.x();
      if (inside < (grown ? -growth_px[k] : 0)) return 120;
    }
    return bright[k] ? 180 : 60;
  }

  RectifiedPair pair() const {
    RandomStream draws({.seed = 42});
    const auto image = [&](bool right) {
      const auto level_at = [&](const Eigen::Vector2d& p) {
        return level(right ? Eigen::Vector2d(p.x() + disparity, p.y()) : p, right);
      };
      return test::with_noise(test::photographed(pair_width, pair_height, 0.8, level_at), 2, draws);
    };
    const GreyLevels left = image(false);
    return {left, image(true)};
  }

  std::vector<test::ConvexPolygon> polygons;
  std::vector<bool> bright;
  std::vector<double> growth_px;
};

StereoTruth level_truth(double disparity_px) {
  return stereo_truth({pair_width, pair_height,
                       std::vector<float>(static_cast<std::size_t>(pair_width) * pair_height,
                                          static_cast<float>(disparity_px))});
}

PairSamples samples_of(const RectifiedPair& pair, const StereoTruth& truth) {
  return pair_samples(pair, truth, {0, 40}, edge_matcher());
}

TEST(PairSamples, ShiftsAreThoseThatWerePutIn) {
  for (const double size : {0.0, 0.4}) {
    const GrowingPolygons scene(size);
    const PairSamples samples = samples_of(scene.pair(), level_truth(disparity));
    double found = 0, put_in = 0, towards = 0;
    for (const SegmentShift& shift : samples.shifts) {
      found += shift.halves_px[0] * shift.halves_px[1];
      towards += std::abs(shift.shift_px);
    }
    for (const double growth : scene.growth_px) put_in += growth * growth;
    const auto segments = static_cast<double>(samples.shifts.size());
    put_in /= static_cast<double>(scene.growth_px.size());
    EXPECT_GE(segments, 40);
    EXPECT_NEAR(std::sqrt(std::max(0.0, found / segments)), std::sqrt(put_in), 0.04) << size;
    EXPECT_NEAR(towards / segments, size, 0.06);
  }
}

/// Every end is a corner of the scene; half of 4 σ² is left of the noise alone.
TEST(PairSamples, EndsOfCleanPolygonsAreKnownToHundredths) {
  const PairSamples samples = samples_of(GrowingPolygons(0).pair(), level_truth(disparity));
  int corners = 0;
  for (const SegmentEnds& ends : samples.ends) {
    if (!ends.a.corner || !ends.b.corner) continue;
    ++corners;
    EXPECT_LT(std::abs(ends.b.across_px - ends.a.across_px), 0.3);
    EXPECT_LT(std::abs(ends.b.along_px - ends.a.along_px), 0.3);
  }
  EXPECT_GE(corners, 40);
}

double lost_share(const std::vector<SegmentLoss>& losses) {
  double shown = 0, found = 0;
  for (const SegmentLoss& loss : losses) shown += loss.shown_px, found += loss.on_segment_px;
  return 1 - found / shown;
}

TEST(PairSamples, LossIsWhatIsErasedAndInThatDirectionAlone) {
  RectifiedPair pair = GrowingPolygons(0).pair();
  const PairSamples whole = samples_of(pair, level_truth(disparity));
  EXPECT_LT(lost_share(whole.losses), 0.02);
  EXPECT_LT(lost_share(whole.losses_to_left), 0.02);
  EXPECT_GT(whole.losses_to_left.size(), 40u);
  // the upper row of polygons, and with it a third of all, is wiped off the right image
  for (std::size_t i = 0; i < static_cast<std::size_t>(pair_width) * cell; ++i)
    pair.right.values[i] = 120;
  const PairSamples erased = samples_of(pair, level_truth(disparity));
  double upper = 0, all = 0;
  for (const SegmentLoss& loss : erased.losses) {
    all += loss.shown_px;
    if (loss.left_px.y() < cell) upper += loss.shown_px;
  }
  EXPECT_NEAR(lost_share(erased.losses), upper / all, 0.02);
  EXPECT_GT(upper / all, 0.2);
  EXPECT_LT(lost_share(erased.losses_to_left), 0.02);
}

TEST(PairSamples, AFalseTruthShowsInAll) {
  const PairSamples samples = samples_of(GrowingPolygons(0).pair(), level_truth(disparity - 9));
  EXPECT_GT(lost_share(samples.losses), 0.5);
  int wrong = 0, matched = 0;
  for (const LineMatch& line : samples.lines) {
    matched += line.matched;
    wrong += line.matched && line.error_px > 3;
  }
  EXPECT_GT(matched, 30);
  EXPECT_EQ(wrong, matched);
}

TEST(PairSamples, LeavesOnASlantedPlaneAreFoundAgain) {
  test::LeafPlane plane;
  plane.by_x = 0.1;
  plane.by_y = -0.05;
  DisparityMap map{plane.width_px, plane.height_px, {}};
  for (int y = 0; y < plane.height_px; ++y) {
    for (int x = 0; x < plane.width_px; ++x) {
      map.values.push_back(static_cast<float>(plane.disparity_at(x, y)));
    }
  }
  const PairSamples samples =
      pair_samples(test::leaf_pair(plane, 3), stereo_truth(map), {0, 64}, edge_matcher());
  EXPECT_LT(lost_share(samples.losses), 0.15);
  EXPECT_LT(lost_share(samples.losses_to_left), 0.15);
  int wrong = 0, matched = 0, found = 0;
  for (const LineMatch& line : samples.lines) {
    matched += line.matched;
    wrong += line.matched && line.error_px > 3;
  }
  EXPECT_GT(matched, 100);
  EXPECT_LE(wrong, 0.02 * matched);
  for (const CornerRepeatability& corner : samples.corners) found += corner.found;
  EXPECT_GT(found, 0.8 * static_cast<double>(samples.corners.size()));
  EXPECT_GT(samples.corner_matches.size(), 50u);
}

/// Against every left pixel's own place.
TEST(TruthOfRight, IsTheLeftOnesMovedOver) {
  DisparityMap left{80, 1, {}};
  for (int x = 0; x < 80; ++x) {
    const bool box = x >= 40 && x < 55;
    left.values.push_back(box ? 20.F : 6 + 0.1F * static_cast<float>(x));
  }
  left.values[10] = std::numeric_limits<float>::quiet_NaN();
  const StereoTruth truth = stereo_truth(left);
  const DisparityMap right = truth_of_right(truth);
  int known = 0;
  for (int x = 0; x < 80; ++x) {
    if (!right.known(x, 0)) continue;
    ++known;
    const float at = static_cast<float>(x) + right(x, 0);  // a left place that shows it
    const int nearest = static_cast<int>(std::lround(at));
    ASSERT_TRUE(nearest >= 0 && nearest < 80);
    EXPECT_NEAR(left(nearest, 0), right(x, 0), 0.06) << x;
  }
  EXPECT_GT(known, 45);
  EXPECT_TRUE(right.known(25, 0));
  EXPECT_EQ(right(25, 0), 20);  // the box
}

TEST(PairSamples, BadInputIsRefused) {
  const RectifiedPair pair = GrowingPolygons(0).pair();
  StereoTruth small = stereo_truth({2, 1, {1, 1}});
  EXPECT_NE(test::error_message([&] { samples_of(pair, small); }).find("size"), std::string::npos);
  const StereoTruth truth = level_truth(disparity);
  EXPECT_NE(test::error_message([&] { pair_samples(pair, truth, {9, 3}, edge_matcher()); }), "");
  RectifiedPair unequal = pair;
  unequal.right = {2, 1, {0, 0}};
  EXPECT_NE(test::error_message([&] { samples_of(unequal, truth); }), "");
  const RectifiedPair blank{
      {pair_width, pair_height, std::vector<float>(pair.left.values.size(), 100)},
      {pair_width, pair_height, std::vector<float>(pair.left.values.size(), 100)}};
  const PairSamples nothing = samples_of(blank, truth);
  EXPECT_TRUE(nothing.losses.empty() && nothing.lines.empty() && nothing.corners.empty());
}

}  // namespace
}  // namespace vernier
