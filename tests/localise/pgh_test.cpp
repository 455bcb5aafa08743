// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/pgh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "stereo/segment.h"
#include "tests/support/rooms.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::stereo;

namespace {

TEST(Pgh, RowsAreUnitAndNotNegative) {
  const Pgh pgh = spatial_histograms(test::random_room(4));
  for (Eigen::Index r = 0; r < pgh.rows.rows(); ++r) {
    EXPECT_NEAR(pgh.rows.row(r).norm(), 1, 1e-6);
    EXPECT_GE(pgh.rows.row(r).minCoeff(), 0);
  }
}

TEST(Pgh, DoesNotDependOnWhereTheRobotStands) {
  const auto room = test::random_room(5);
  const Pgh here = spatial_histograms(room);
  const Pgh there = spatial_histograms(test::seen_from(room, {0.2, -0.3, 0.7}));
  ASSERT_EQ(here.rows.rows(), there.rows.rows());
  EXPECT_LT((here.rows - there.rows).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Pgh, AFragmentedLineContributesTheSame) {
  auto room = test::random_room(6);
  const Pgh whole = spatial_histograms(room);
  // cut line 1 (level) in two: line 0's histogram stays
  PlaceLine second = room[1];
  const Eigen::Vector3d middle = 0.5 * (room[1].a_m + room[1].b_m);
  room[1].b_m = middle;
  second.a_m = middle;
  room.push_back(second);
  const Pgh cut = spatial_histograms(room);
  EXPECT_GT(whole.rows.row(0).dot(cut.rows.row(0)), 0.9999f);
}

TEST(Pgh, ImageHistogramsIgnoreShiftAndTurnInThePlane) {
  std::vector<ImageSegment> lines, moved;
  const Eigen::Rotation2Dd R(0.4);
  for (int i = 0; i < 30; ++i) {
    RandomStream d({.seed = 8, .feature = static_cast<std::uint32_t>(i)});
    const Eigen::Vector2d a{d.uniform(0, 640), d.uniform(0, 480)};
    const Eigen::Vector2d b = a + Eigen::Vector2d{d.uniform(-90, 90), d.uniform(-90, 90)};
    lines.push_back({a, b});
    moved.push_back({R * a + Eigen::Vector2d(30, -12), R * b + Eigen::Vector2d(30, -12)});
  }
  const PghOptions options = image_pgh_options();
  const Pgh p = image_histograms(lines, options), q = image_histograms(moved, options);
  ASSERT_EQ(p.rows.rows(), q.rows.rows());
  EXPECT_LT((p.rows - q.rows).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Pgh, KeepsTheLongestLines) {
  PghOptions options;
  options.max_lines = 10;
  EXPECT_EQ(spatial_histograms(test::random_room(9), options).rows.rows(), 10);
  EXPECT_EQ(spatial_histograms({}, options).rows.rows(), 0);
}

TEST(Pgh, LinesWithoutALengthAreIgnored) {
  const auto room = test::random_room(9);
  const Pgh whole = spatial_histograms(room);
  auto with_points = room;
  const PlaceLine point{room[0].a_m, room[0].a_m, LineKind::vertical, 0.1};
  PlaceLine lost = room[1];
  lost.b_m.x() = std::nan("");
  with_points.insert(with_points.begin() + 3, point);
  with_points.push_back(lost);
  const Pgh kept = spatial_histograms(with_points);
  ASSERT_EQ(kept.rows.rows(), whole.rows.rows());
  EXPECT_EQ(kept.rows, whole.rows);
  EXPECT_EQ(kept.weights, whole.weights);

  std::vector<ImageSegment> lines;
  for (const double x : {10.0, 60.0, 200.0}) lines.push_back({{x, 20}, {x + 30, 200}});
  const PghOptions options = image_pgh_options();
  const Pgh three = image_histograms(lines, options);
  ASSERT_EQ(three.rows.rows(), 3);
  lines.insert(lines.begin(), {{50, 50}, {50, 50}});
  const Pgh again = image_histograms(lines, options);
  ASSERT_EQ(again.rows.rows(), 3);
  EXPECT_EQ(again.rows, three.rows);
}

TEST(Pgh, RowsNameTheirLines) {
  auto room = test::random_room(9, 6);
  room.insert(room.begin() + 2, {room[0].a_m, room[0].a_m, LineKind::vertical, 0.1});
  EXPECT_EQ(spatial_histograms(room).lines, (std::vector<int>{0, 1, 3, 4, 5, 6}));
}

/// Casts of what exceeds an int are undefined, and seen by the sanitizers.
TEST(Pgh, HugeCoordinatesAreOutOfReach) {
  const auto room = test::random_room(9);
  for (const PghType type : {PghType::mirror, PghType::rotation, PghType::directed}) {
    for (const double far : {1e10, 1e60, 1e154, 1e300}) {
      PghOptions options;
      options.type = type;
      auto with_far = room;
      PlaceLine line = room[1];
      line.a_m.z() = far;
      line.b_m = line.a_m;
      line.b_m.x() -= 0.1 * far;
      with_far.push_back(line);
      const Pgh pgh = spatial_histograms(with_far, options);
      const Pgh alone = spatial_histograms(room, options);
      ASSERT_GE(pgh.rows.rows(), alone.rows.rows());
      EXPECT_TRUE(pgh.rows.allFinite());
      EXPECT_LT((pgh.rows.topRows(alone.rows.rows()) - alone.rows).cwiseAbs().maxCoeff(), 1e-5);
      EXPECT_TRUE(ground_histograms(with_far, options).rows.allFinite());

      PghOptions of_image = image_pgh_options();
      of_image.type = type;
      const std::vector<ImageSegment> lines{
          {{1, 2}, {90, 70}}, {{9, 8}, {7, -60}}, {{far, 1}, {1, far}}};
      EXPECT_TRUE(image_histograms(lines, of_image).rows.allFinite());
    }
  }
}

/// Uprights have no row, and no angle in those of others.
TEST(GroundHistograms, UprightsArePoints) {
  const PlaceLine wall{{1, 0, 0.1}, {3, 0, 0.1}, LineKind::level};
  const PlaceLine post{{2, 1, 0}, {2, 1, 1.5}, LineKind::vertical};
  const std::vector<PlaceLine> lines{post, wall};
  const Pgh pgh = ground_histograms(lines);
  ASSERT_EQ(pgh.lines, std::vector<int>{1});
  EXPECT_FLOAT_EQ(pgh.weights[0], 2);
  const HistogramRows plain = plain_histograms(pgh);
  const PghAxes& axes = pgh.axes;
  ASSERT_EQ(axes.bands, 2);
  double mean = 0;
  for (int d = 0; d < axes.distance_bins; ++d) {
    for (int a = 0; a < axes.angle_bins; ++a) {
      EXPECT_EQ(plain(0, axes.column(0, a, d)), 0);
      EXPECT_NEAR(plain(0, axes.column(1, a, d)), plain(0, axes.column(1, 0, d)), 1e-7);
      mean += plain(0, axes.column(1, a, d)) * (d + 0.5) * axes.max_distance / axes.distance_bins;
    }
  }
  EXPECT_NEAR(mean, 1, 1e-3);
}

/// The floor plan is the same at any height.
TEST(GroundHistograms, IgnoreHeights) {
  const auto room = test::random_room(4);
  auto raised = room;
  for (std::size_t i = 0; i < room.size(); ++i) {
    raised[i].a_m.z() += 0.1 * i;
    raised[i].b_m.z() += 0.1 * i;
  }
  const Pgh p = ground_histograms(room), q = ground_histograms(raised);
  EXPECT_LT((p.rows - q.rows).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Pgh, BadOptionsAreRefused) {
  PghOptions options;
  options.distance_sigma = 0;
  EXPECT_THROW(spatial_histograms(test::random_room(9), options), Error);
  options = {};
  options.band_height_m = 0;
  EXPECT_THROW(spatial_histograms(test::random_room(9), options), Error);
  options = {.angle_bins = 10'000, .distance_bins = 10'000};
  EXPECT_THROW(ground_histograms(test::random_room(9), options), Error);
  options = {.max_distance = std::numeric_limits<double>::infinity()};
  EXPECT_THROW(image_histograms({}, options), Error);
}

}  // namespace
}  // namespace vernier
