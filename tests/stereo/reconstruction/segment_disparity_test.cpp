// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/reconstruction/segment_disparity.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "calib/base/decompositions.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "tests/support/edge_images.h"
#include "tests/support/error_message.h"
#include "tests/support/step_pair.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

RandomStream draws_of(std::uint64_t seed) {
  return RandomStream({.seed = seed, .source = static_cast<std::uint32_t>(DrawSource::noisy_copy)});
}

/// Points of one straight edge, one a row, with the disparities asked for.
class OneEdge : public testing::Test {
 protected:
  /// x = 40 + slant (y − 10) from row 10 on.
  void make(int rows, const std::function<double(int)>& disparity, double slant = 0.3) {
    edges.clear();
    found.clear();
    segment.points.clear();
    const Eigen::Vector2f normal = Eigen::Vector2f(-1, static_cast<float>(slant)).normalized();
    for (int i = 0; i < rows; ++i) {
      EdgePoint p;
      p.y = 10 + i;
      p.row_x_px = static_cast<float>(40 + slant * i);
      p.x = static_cast<int>(std::lround(p.row_x_px));
      p.pixel_px = {p.row_x_px, static_cast<float>(p.y)};
      p.normal = normal;
      p.sigma_px = 0.04f;
      edges.push_back(p);
      segment.points.push_back(i);
      found.push_back({static_cast<float>(disparity(i)), 0.25f, 1});
    }
    segment.segment = {edges.front().pixel_px.cast<double>(), edges.back().pixel_px.cast<double>()};
    const Eigen::Vector2d n = normal.cast<double>(), t(-n.y(), n.x());
    segment.a_covariance_px2 = segment.b_covariance_px2 =
        1e-3 * n * n.transpose() + 9 * t * t.transpose();
  }
  std::vector<SegmentDisparity> parts(const SegmentDisparityOptions& options = {}) const {
    return segment_disparities(edges, {segment}, found, options);
  }
  static constexpr float none = std::numeric_limits<float>::quiet_NaN();
  std::vector<EdgePoint> edges;
  std::vector<EdgeDisparity> found;
  EdgeSegment segment;
};

TEST_F(OneEdge, ALineIsFoundExactly) {
  make(30, [](int i) { return 20 + 0.1 * i; });
  const auto all = parts();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].status, SegmentStatus::placed);
  EXPECT_FALSE(all[0].is_part);
  EXPECT_NEAR(all[0].a_disparity_px, 20, 1e-4);
  EXPECT_NEAR(all[0].b_disparity_px, 22.9, 1e-4);
  EXPECT_EQ(all[0].points.size(), 30u);
  EXPECT_EQ(all[0].edge_points, 30);
  EXPECT_NEAR(all[0].right_px().a_px.x(), 20, 1e-4);
  EXPECT_GT(symmetric_eigenvalues(all[0].covariance_px2)[0], 0);
  // The ends keep their own covariance.
  EXPECT_LT((all[0].covariance_px2.topLeftCorner<2, 2>() - segment.a_covariance_px2).norm(), 1e-9);
  EXPECT_LT((all[0].covariance_px2.block<2, 2>(2, 2) - segment.b_covariance_px2).norm(), 1e-9);
}

TEST_F(OneEdge, WrongMatchesAreLeftOut) {
  make(30, [](int i) { return i % 5 == 2 ? 45 + i : 20 + 0.1 * i; });
  const auto all = parts();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].points.size(), 24u);
  EXPECT_NEAR(all[0].a_disparity_px, 20, 1e-4);
}

TEST_F(OneEdge, TwoSurfacesSplitIt) {
  make(30, [](int i) { return i < 18 ? 20.0 : 26.0 - 0.05 * i; });
  const auto all = parts();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_TRUE(all[0].is_part && all[1].is_part);
  EXPECT_EQ(all[0].points.size(), 18u);
  EXPECT_EQ(all[1].points.size(), 12u);
  EXPECT_NEAR(all[0].b_disparity_px, 20, 1e-4);
  EXPECT_NEAR(all[1].a_disparity_px, 25.1, 1e-3);
  EXPECT_LT(all[0].left_px.b_px.y(), all[1].left_px.a_px.y());
}

TEST_F(OneEdge, APartEndsWhereItsMatchesDo) {
  make(40, [](int i) { return i < 15 ? 20.0 : NAN; });
  const auto all = parts();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_TRUE(all[0].is_part);
  EXPECT_NEAR(all[0].left_px.b_px.y(), 24, 0.5);
  EXPECT_EQ(all[0].left_px.a_px, segment.segment.a_px);
}

TEST_F(OneEdge, RefusalsSayWhy) {
  make(30, [](int i) { return i < 4 ? 20.0 : NAN; });
  EXPECT_EQ(parts().at(0).status, SegmentStatus::unmatched);
  make(30, [](int i) { return i % 4 == 0 ? 20.0 : NAN; });  // of 30, 8
  EXPECT_EQ(parts().at(0).status, SegmentStatus::unmatched);
  make(30, [](int i) { return 10 + (37 * i * i) % 31; });
  EXPECT_EQ(parts().at(0).status, SegmentStatus::disagree);
  make(
      30, [](int) { return 20.0; }, 15);  // 3.8° from the row
  EXPECT_EQ(parts().at(0).status, SegmentStatus::along_row);
  EXPECT_NE(parts({.min_angle_rad = 0.05}).at(0).status, SegmentStatus::along_row);
  EXPECT_NE(std::string(describe(SegmentStatus::disagree)).find("no common line"),
            std::string::npos);
}

TEST_F(OneEdge, BadInputIsNamed) {
  make(30, [](int) { return 20.0; });
  found.pop_back();
  EXPECT_NE(test::error_message([&] { parts(); }).find("differ in number"), std::string::npos);
  found.push_back({});
  segment.points.push_back(30);
  EXPECT_NE(test::error_message([&] { parts(); }).find("not in the edges"), std::string::npos);
  segment.points.pop_back();
  EXPECT_NE(test::error_message([&] { parts({.min_points = 2}); }).find("out of range"),
            std::string::npos);
}

/// Disparities drawn with the noise that is assumed: shared by the overlap of patches, and a floor.
/// Whitened by the stated covariance both coefficients of the line are χ² of 2 over 2000 draws. The
/// factor max(1, …) makes it a little too large, never too small: the false-alarm rate of the lower
/// bound is 1e-3 after 15 % for that, of the upper 1e-3 (seed 501 fixed).
TEST_F(OneEdge, CorrelatedNoiseHasTheStatedCovariance) {
  const int n = 40;
  make(
      n, [](int) { return 20.0; }, 0);
  const SegmentDisparityOptions options;
  Eigen::MatrixXd C(n, n);
  const double noise = std::sqrt(0.25 * 0.25 - options.floor_px * options.floor_px);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double apart = std::abs(i - j);
      C(i, j) = noise * noise * std::max(0.0, 1 - apart / 7) +
                std::pow(options.floor_px, 2) * std::exp(-apart / options.floor_length_px);
    }
  }
  const Eigen::MatrixXd root = Cholesky(C).lower();
  RandomStream draws = draws_of(501);
  const int trials = 2000;
  double sum = 0, independent = 0;
  for (int k = 0; k < trials; ++k) {
    const Eigen::VectorXd e = root * draws.normals(n);
    for (int i = 0; i < n; ++i)
      found[static_cast<std::size_t>(i)].disparity_px = static_cast<float>(20 + e[i]);
    const auto all = parts();
    ASSERT_EQ(all.size(), 1u);
    const Eigen::Vector2d off(all[0].a_disparity_px - 20, all[0].b_disparity_px - 20);
    const Eigen::Matrix2d stated = all[0].covariance_px2.bottomRightCorner<2, 2>();
    sum += off.dot(stated.inverse() * off);
    independent += off.squaredNorm() / (2 * 0.25 * 0.25 * 4 / n);  // as if points were
  }
  EXPECT_GT(sum, 0.85 * chi_squared_quantile(1e-3, 2 * trials));
  EXPECT_LT(sum, chi_squared_quantile(1 - 1e-3, 2 * trials));
  EXPECT_GT(independent / trials, 5);  // or the test would tell nothing of the correlation
}

/// Rendered edges through all of it: Canny, the matcher with its own σ, the segment. The errors of
/// the segment's place across, at both ends, and of its disparities there are measured against the
/// stated 4 x 4 covariance.
struct Whitened {
  double mean_nees = 0, share_below_95 = 0, share_below_50 = 0;
  int count = 0;
};

Whitened rendered(double angle, double by_y, int trials) {
  const test::StepPair pair{{{70.3, 50.2}, angle}, 12.3, by_y};
  const RectifiedPair clean = pair.images(140, 100);
  Whitened w;
  for (int k = 0; k < trials; ++k) {
    RandomStream draws = draws_of(600 + static_cast<std::uint64_t>(k));
    const RectifiedPair noisy{test::with_noise(clean.left, 2, draws),
                              test::with_noise(clean.right, 2, draws)};
    const std::vector<EdgePoint> edges = canny_edges(noisy.left);
    const auto found = edge_matcher({.sigma_floor_px = 0}).match(noisy, edges, {0, 30});
    for (const SegmentDisparity& s :
         segment_disparities(edges, edge_segments(edges), found, {.floor_px = 0})) {
      if (s.status != SegmentStatus::placed || s.left_px.length_px() < 40) continue;
      const Eigen::Vector2d n = pair.left.normal();
      Eigen::Matrix<double, 4, 6> J = Eigen::Matrix<double, 4, 6>::Zero();
      Eigen::Vector4d off;
      for (int end = 0; end < 2; ++end) {
        const Eigen::Vector2d& p = end == 0 ? s.left_px.a_px : s.left_px.b_px;
        J.block<1, 2>(end, 2 * end) = n.transpose();
        off[end] = pair.left.distance(p);
        // At the row of the end: where it slides along the edge takes its disparity with it.
        J.block<1, 2>(2 + end, 2 * end) = -by_y * Eigen::RowVector2d(0, 1);
        J(2 + end, 4 + end) = 1;
        off[2 + end] = (end == 0 ? s.a_disparity_px : s.b_disparity_px) - pair.disparity_at(p.y());
      }
      const Eigen::Matrix4d C = J * s.covariance_px2 * J.transpose();
      const double nees = off.dot(C.inverse() * off);
      w.mean_nees += nees;
      w.share_below_95 += nees < chi_squared_quantile(0.95, 4);
      w.share_below_50 += nees < chi_squared_quantile(0.5, 4);
      ++w.count;
    }
  }
  w.mean_nees /= w.count;
  w.share_below_95 /= w.count;
  w.share_below_50 /= w.count;
  testing::Test::RecordProperty("nees", std::to_string(w.mean_nees));
  testing::Test::RecordProperty("below_95", std::to_string(w.share_below_95));
  testing::Test::RecordProperty("below_50", std::to_string(w.share_below_50));
  return w;
}

/// Of 4 degrees of freedom, the mean over 150 edges has a standard deviation of 0.23: the upper
/// bound is 3 of them above 4, a false-alarm rate of 1e-3 each, and so is the share below the 95 %
/// quantile 0.054 under it. The matcher says 15 % too much of edges alone in a flat surrounding,
/// and both lines' covariances are never below the noise's, so that the mean is 2.5 to 3.5; lower
/// than 2 would say that the stated deviations are 1.4 times too large. Along the column all points
/// have one sub-pixel phase, whose interpolation error is no noise: 4.6 there.
TEST(SegmentDisparity, RenderedEdgesAreAsGoodAsStated) {
  for (const double angle : {0.1, 0.45, -0.8, 1.1}) {
    for (const double by_y : {0.0, 0.1}) {
      const Whitened w = rendered(angle, by_y, 150);
      SCOPED_TRACE(testing::Message() << angle << ' ' << by_y);
      ASSERT_GT(w.count, 130);
      EXPECT_LT(w.mean_nees, angle == 0.1 ? 5.2 : 4.7);
      EXPECT_GT(w.mean_nees, 2);
      EXPECT_GT(w.share_below_95, 0.896);
      EXPECT_LT(w.share_below_50, 0.85);
    }
  }
}

}  // namespace
}  // namespace vernier
