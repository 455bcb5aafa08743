// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/joined_lines.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "localise/join/line_fit.h"
#include "tests/support/error_message.h"
#include "tests/support/line_scenes.h"

namespace vernier::localise {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using test::error_message;
using test::random_lines;
using test::Scene;
using test::scene_of;
using test::TrueLine;
using vernier::internal::RandomStream;

/// Squared Mahalanobis distance of the true infinite line at the ends of a joined one.
double nees(const JoinedLine& line, const TrueLine& truth) {
  const Vector3d z = (line.b_m - line.a_m).normalized(), x = z.unitOrthogonal(), y = z.cross(x);
  const Vector3d d = truth.b_m - truth.a_m;
  Eigen::Vector4d error;
  Eigen::Matrix<double, 4, 6> P = Eigen::Matrix<double, 4, 6>::Zero();
  for (int end = 0; end < 2; ++end) {
    const Vector3d& p = end == 0 ? line.a_m : line.b_m;
    const Vector3d nearest = truth.a_m + d * (z.dot(p - truth.a_m) / z.dot(d));
    error.segment<2>(2 * end) << x.dot(nearest - p), y.dot(nearest - p);
    P.block<1, 3>(2 * end, 3 * end) = x.transpose();
    P.block<1, 3>(2 * end + 1, 3 * end) = y.transpose();
  }
  const Eigen::Matrix4d C = P * line.covariance_m2 * P.transpose();
  return error.dot(C.llt().solve(error));
}

JoinOptions exact_poses() {
  JoinOptions options;
  options.view_position_m = options.view_turn_rad = options.shared_m = 0;
  return options;
}

/// Of all pairs of segments: shares of truly equal ones that are joined, and of joined ones that
/// are truly equal.
struct PairShares {
  double complete = 0, pure = 0;
};

PairShares pair_shares(const Scene& scene, const JoinedLines& joined) {
  std::map<std::pair<int, int>, double> cells;
  std::map<int, double> of_truth, of_joined;
  for (std::size_t v = 0; v < scene.truth.size(); ++v) {
    for (std::size_t i = 0; i < scene.truth[v].size(); ++i) {
      const int line = joined.line_of[v][i];
      if (line == JoinedLines::none) continue;
      ++cells[{scene.truth[v][i], line}];
      ++of_truth[scene.truth[v][i]];
      ++of_joined[line];
    }
  }
  const auto pairs = [](const auto& counts) {
    double sum = 0;
    for (const auto& [key, n] : counts) sum += n * (n - 1) / 2;
    return sum;
  };
  return {pairs(cells) / pairs(of_truth), pairs(cells) / pairs(of_joined)};
}

TEST(JoinedLines, InformationAddsUp) {
  const Scene scene = scene_of(random_lines(1, 0), 8, 0, {});
  std::vector<vernier::localise::internal::WorldSighting> all;
  for (const SegmentsOfView& view : scene.views) {
    all.push_back(vernier::localise::internal::in_world(view.segments[0], view.T_world_camera, {}));
  }
  std::vector<const vernier::localise::internal::WorldSighting*> members;
  for (const auto& s : all) members.push_back(&s);
  const vernier::localise::internal::FittedLine together =
      vernier::localise::internal::fitted(members);
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const auto& s : all) {
    const vernier::localise::internal::LineMeasurement m =
        vernier::localise::internal::measured(s, together.frame);
    sum += m.by_line().transpose() * m.covariance_m2.inverse() * m.by_line();
  }
  EXPECT_LT((sum - together.information).norm(), 1e-6 * sum.norm());
  // the same again halves the covariance and leaves the line
  members.insert(members.end(), members.begin(), members.end());
  const vernier::localise::internal::FittedLine twice =
      vernier::localise::internal::fitted(members);
  EXPECT_LT((2 * twice.covariance - together.covariance).norm(), 1e-6 * together.covariance.norm());
  EXPECT_LT((twice.frame.axes.col(2) - together.frame.axes.col(2)).norm(), 1e-9);
}

TEST(JoinedLines, StatedCovarianceIsThatOfErrors) {
  // false alarm in 1 of 1,000 seeds on either side
  double sum = 0, chi2 = 0;
  int lines = 0, dof = 0;
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    // far apart, so that the association is certain
    std::vector<TrueLine> truth;
    for (int i = 0; i < 8; ++i) {
      const double y = -1.75 + 0.5 * i;
      const Vector3d d = rotation_from_vector({0.1 * i, 0.02 * trial, 0}) * Vector3d(0, 0.05, 0.4);
      truth.push_back({Vector3d(0, y, 1.2) - d, Vector3d(0, y, 1.2) + d});
    }
    const Scene scene = scene_of(truth, 6, trial, exact_poses());
    JoinOptions options = exact_poses();
    options.gate = 1000;  // a gate cuts the tail of chi2
    const JoinedLines joined = join_lines(scene.views, options);
    ASSERT_EQ(joined.lines.size(), truth.size());
    for (const JoinedLine& line : joined.lines) {
      EXPECT_EQ(line.views, 6);
      sum += nees(line, truth[scene.truth[0][line.sightings[0].segment]]);
      chi2 += line.chi2;
      dof += 4 * (static_cast<int>(line.sightings.size()) - 1);
      ++lines;
    }
  }
  using vernier::internal::chi_squared_quantile;
  RecordProperty("nees_of_4", std::to_string(sum / lines));
  RecordProperty("chi2_by_dof", std::to_string(chi2 / dof));
  EXPECT_GT(sum, chi_squared_quantile(0.001, 4 * lines));
  EXPECT_LT(sum, chi_squared_quantile(0.999, 4 * lines));
  EXPECT_GT(chi2, chi_squared_quantile(0.001, dof));
  EXPECT_LT(chi2, chi_squared_quantile(0.999, dof));
}

TEST(JoinedLines, PosesErrAsStated) {
  // one line a scene, so that scenes are independent: 1 of 1,000 seeds on either side
  double sum = 0;
  const int trials = 200;
  JoinOptions options;
  options.shared_m = 0;
  options.gate = 1000;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const std::vector<TrueLine> truth{{{0, 0, 0.8}, {0.1, 0.2, 1.7}}};
    const Scene scene = scene_of(truth, 5, 1000 + trial, options);
    const JoinedLines joined = join_lines(scene.views, options);
    ASSERT_EQ(joined.lines.size(), 1U);
    sum += nees(joined.lines[0], truth[0]);
  }
  using vernier::internal::chi_squared_quantile;
  RecordProperty("nees_of_4", std::to_string(sum / trials));
  EXPECT_GT(sum, chi_squared_quantile(0.001, 4 * trials));
  EXPECT_LT(sum, chi_squared_quantile(0.999, 4 * trials));
}

TEST(JoinedLines, SharedErrorDoesNotAverageAway) {
  const std::vector<TrueLine> truth{{{0, 0, 0.8}, {0.1, 0.2, 1.7}}};
  JoinOptions options;
  options.shared_m = 0.02;
  const auto least_sigma = [&](int views) {
    const JoinedLines joined = join_lines(scene_of(truth, views, 3, options).views, options);
    const Vector3d x = (truth[0].b_m - truth[0].a_m).unitOrthogonal();
    const JoinedLine& line = joined.lines.at(0);
    return std::sqrt(x.dot(line.covariance_m2.topLeftCorner<3, 3>() * x));
  };
  EXPECT_GT(least_sigma(4), least_sigma(60));
  EXPECT_GT(least_sigma(60), 0.02);
  EXPECT_LT(least_sigma(60), 0.021);
}

TEST(JoinedLines, AssociationIsCompleteAndPure) {
  const std::vector<TrueLine> truth = random_lines(150, 1);
  const Scene scene = scene_of(truth, 30, 50, {}, 0.7);
  const JoinedLines joined = join_lines(scene.views);
  const PairShares shares = pair_shares(scene, joined);
  RecordProperty("complete", std::to_string(shares.complete));
  RecordProperty("pure", std::to_string(shares.pure));
  EXPECT_GT(shares.complete, 0.97);
  EXPECT_GT(shares.pure, 0.97);
  const auto often = std::count_if(joined.lines.begin(), joined.lines.end(),
                                   [](const JoinedLine& line) { return line.views >= 2; });
  EXPECT_GE(often, 147);
  EXPECT_LE(often, 156);
}

TEST(JoinedLines, IndicesAgree) {
  const Scene scene = scene_of(random_lines(40, 2), 10, 60, {}, 0.7);
  const JoinedLines joined = join_lines(scene.views);
  std::set<std::pair<int, int>> found;
  for (std::size_t i = 0; i < joined.lines.size(); ++i) {
    std::set<int> views;
    for (const LineSighting& s : joined.lines[i].sightings) {
      EXPECT_EQ(joined.line_of.at(s.view).at(s.segment), static_cast<int>(i));
      EXPECT_TRUE(found.insert({s.view, s.segment}).second);
      EXPECT_LT(s.low_m, s.high_m);
      views.insert(s.view);
    }
    EXPECT_EQ(joined.lines[i].views, static_cast<int>(views.size()));
  }
  std::size_t segments = 0;
  for (const SegmentsOfView& view : scene.views) segments += view.segments.size();
  EXPECT_EQ(found.size(), segments);
}

TEST(JoinedLines, ParallelLinesStayApart) {
  for (const Vector3d& step : {Vector3d(0.05, 0, 0), Vector3d(0, 0.05, 0)}) {
    const TrueLine one{{0, 0, 0.6}, {0, 0, 1.8}};
    const std::vector<TrueLine> truth{one, {one.a_m + step, one.b_m + step}};
    const Scene scene = scene_of(truth, 20, 70, {}, 0.9);
    const JoinedLines joined = join_lines(scene.views);
    EXPECT_EQ(joined.lines.size(), 2U);
    EXPECT_EQ(pair_shares(scene, joined).pure, 1);
  }
}

TEST(JoinedLines, EdgesOfOneViewAreNeverOneLine) {
  // 4 mm apart, below the noise: but each view sees both
  const TrueLine one{{0, 0, 0.6}, {0, 0, 1.8}};
  const Vector3d step(0.004, 0, 0);
  const Scene scene = scene_of({one, {one.a_m + step, one.b_m + step}}, 6, 80, {});
  for (const JoinedLine& line : join_lines(scene.views).lines) {
    EXPECT_EQ(static_cast<int>(line.sightings.size()), line.views);
  }
}

TEST(JoinedLines, CollinearEdgesWithAGapAreTwo) {
  const std::vector<TrueLine> truth{{{0, -1, 1}, {0, -0.3, 1}}, {{0, 0.3, 1}, {0, 1, 1}}};
  const Scene scene = scene_of(truth, 10, 90, {});
  EXPECT_EQ(join_lines(scene.views).lines.size(), 2U);
}

TEST(JoinedLines, ReachesAsFarAsSightingsDo) {
  const TrueLine truth{{0, -0.5, 1}, {0, 0.5, 1}};
  const JoinedLine line = join_lines(scene_of({truth}, 40, 95, {}).views).lines.at(0);
  // parts begin in the first 30 % and end in the last: the fourth of 40 is at about 3 %
  const double y0 = std::min(line.a_m.y(), line.b_m.y()), y1 = std::max(line.a_m.y(), line.b_m.y());
  EXPECT_NEAR(y0, -0.47, 0.025);
  EXPECT_NEAR(y1, 0.47, 0.025);
}

TEST(JoinedLines, OneOverlongSightingDoesNotLengthenIt) {
  const TrueLine truth{{0, -0.5, 1}, {0, 0.5, 1}};
  Scene scene = scene_of({truth}, 6, 96, exact_poses());
  const Pose& T = scene.views[0].T_world_camera;
  scene.views[0].segments[0].b_m = T.inverse() * Vector3d(0, 1.5, 1);
  scene.views[0].segments[0].a_m = T.inverse() * Vector3d(0, -0.4, 1);
  const JoinedLine line = join_lines(scene.views).lines.at(0);
  EXPECT_EQ(line.views, 6);
  EXPECT_LT(std::max(line.a_m.y(), line.b_m.y()), 0.55);
}

TEST(JoinedLines, UncertainSegmentsAreLeftOut) {
  Scene scene = scene_of({{{0, 0, 0.8}, {0.1, 0.2, 1.7}}}, 3, 97, {});
  scene.views[1].segments[0].covariance_m2 *= 1e4;
  const JoinedLines joined = join_lines(scene.views);
  ASSERT_EQ(joined.lines.size(), 1U);
  EXPECT_EQ(joined.lines[0].views, 2);
  EXPECT_EQ(joined.line_of[1][0], JoinedLines::none);
}

TEST(JoinedLines, RefusesWhatIsNoSegment) {
  const Scene good = scene_of({{{0, 0, 0.8}, {0.1, 0.2, 1.7}}}, 2, 98, {});
  const auto message = [&](auto spoil) {
    std::vector<SegmentsOfView> views = good.views;
    spoil(views[1].segments[0]);
    return error_message([&] { join_lines(views); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message([&](SightedSegment& s) { s.a_m.x() = nan; }).find("segment 0 of view 1"),
            std::string::npos);
  EXPECT_NE(message([](SightedSegment& s) { s.b_m = s.a_m; }).find("no length"), std::string::npos);
  EXPECT_NE(message([](SightedSegment& s) { s.covariance_m2 *= -1; }).find("semidefinite"),
            std::string::npos);
  EXPECT_NE(message([](SightedSegment& s) { s.covariance_m2(0, 5) += 1; }).find("symmetric"),
            std::string::npos);
  JoinOptions options;
  options.gate = 0;
  EXPECT_NE(error_message([&] { join_lines(good.views, options); }).find("gate"),
            std::string::npos);
  EXPECT_TRUE(join_lines({}).lines.empty());
}

TEST(ProjectedLine, IsCutAtTheImageAndTheNearPlane) {
  Camera camera;
  camera.model = Pinhole{};
  camera.parameters = Eigen::Vector4d(500, 1, 319.5, 239.5);
  JoinedLine line;
  line.a_m = {-5, 0, 2};
  line.b_m = {5, 0, 2};
  const auto across = projected_line(line, camera, {});
  ASSERT_TRUE(across);
  EXPECT_NEAR(across->image_px.a_px.x(), -0.5, 1e-6);
  EXPECT_NEAR(across->image_px.b_px.x(), 639.5, 1e-6);
  EXPECT_NEAR(across->t0, (5 - 320 / 500.0 * 2) / 10, 1e-9);
  line.a_m = {0.1, 0, -3};
  line.b_m = {0.1, 0, 5};
  const auto ahead = projected_line(line, camera, {});
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(ahead->image_px.b_px.x(), 319.5 + 500 * 0.1 / 5, 1e-9);
  EXPECT_NEAR(ahead->image_px.a_px.x(), 639.5, 1e-6);
  line.a_m = {0.1, 0, -3};
  line.b_m = {0.1, 0, -1};
  EXPECT_FALSE(projected_line(line, camera, {}));
}

}  // namespace
}  // namespace vernier::localise
