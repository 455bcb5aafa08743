// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/pgh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

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

/// Oracle: both segments sampled densely, every sample smeared into every bin by the error
/// function, with nothing analytic about stretches.
HistogramRows brute_force(const std::vector<PlaceLine>& lines, const PghOptions& o) {
  const int bins = o.height_bands * o.angle_bins * o.distance_bins;
  HistogramRows rows = HistogramRows::Zero(static_cast<Eigen::Index>(lines.size()), bins);
  const auto cdf = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  for (std::size_t r = 0; r < lines.size(); ++r) {
    const Eigen::Vector3d u = (lines[r].b_m - lines[r].a_m).normalized();
    Eigen::VectorXd h = Eigen::VectorXd::Zero(bins);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (k == r) continue;
      const Eigen::Vector3d d = lines[k].b_m - lines[k].a_m;
      const double angle = std::acos(std::min(1.0, std::abs(u.dot(d.normalized()))));
      const double height = 0.5 * (lines[k].a_m.z() + lines[k].b_m.z());
      const int band =
          std::clamp(static_cast<int>(std::floor(height / o.band_height_m)), 0, o.height_bands - 1);
      const int samples = 400;
      for (int i = 0; i < samples; ++i) {
        const Eigen::Vector3d x = lines[k].a_m + d * (i + 0.5) / samples - lines[r].a_m;
        const double distance = (x - u * u.dot(x)).norm();
        const double mass = std::min(o.max_weight_m, d.norm()) / samples;
        for (int a = 0; a < o.angle_bins; ++a) {
          double share = 0;
          const double w = M_PI / 2 / o.angle_bins;
          for (const double mirrored : {angle, -angle, M_PI - angle}) {
            share += cdf(((a + 1) * w - mirrored) / o.angle_sigma_rad) -
                     cdf((a * w - mirrored) / o.angle_sigma_rad);
          }
          for (int b = 0; b < o.distance_bins; ++b) {
            const double v = o.max_distance / o.distance_bins;
            double part = 0;
            for (const double mirrored : {distance, -distance}) {
              part += cdf(((b + 1) * v - mirrored) / o.distance_sigma) -
                      cdf((b * v - mirrored) / o.distance_sigma);
            }
            h[(band * o.angle_bins + a) * o.distance_bins + b] += mass * share * part;
          }
        }
      }
    }
    rows.row(static_cast<Eigen::Index>(r)) = (h / h.sum()).cwiseSqrt().cast<float>();
  }
  return rows;
}

TEST(Pgh, IsTheDenselySampledHistogram) {
  const auto room = test::random_room(3, 12);
  const PghOptions options;
  const Pgh pgh = spatial_histograms(room, options);
  const HistogramRows oracle = brute_force(room, options);
  ASSERT_EQ(pgh.rows.rows(), oracle.rows());
  for (Eigen::Index r = 0; r < oracle.rows(); ++r) {
    // Bhattacharyya coefficient of ours with the oracle's. A stretch counts as uniform in
    // distance, which for a line passing at an angle it is not quite.
    EXPECT_GT(pgh.rows.row(r).dot(oracle.row(r)), 0.999) << r;
  }
}

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
    const Eigen::Vector2d a(d.uniform(0, 640), d.uniform(0, 480));
    const Eigen::Vector2d b = a + Eigen::Vector2d(d.uniform(-90, 90), d.uniform(-90, 90));
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

TEST(Pgh, BadOptionsAreRefused) {
  PghOptions options;
  options.distance_sigma = 0;
  EXPECT_THROW(spatial_histograms(test::random_room(9), options), Error);
  options = {};
  options.band_height_m = 0;
  EXPECT_THROW(spatial_histograms(test::random_room(9), options), Error);
}

}  // namespace
}  // namespace vernier
