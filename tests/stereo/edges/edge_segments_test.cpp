// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/edge_segments.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_chains.h"
#include "stereo/grey_levels.h"
#include "tests/support/edge_images.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

constexpr int segments_side = 160;
using std::numbers::pi;

/// Bright on dark, or dark on bright.
GreyLevels image_of(const test::ConvexPolygon& polygon, bool bright) {
  return test::photographed(segments_side, segments_side, 0.8, [&](const Eigen::Vector2d& p) {
    return polygon.holds(p) == bright ? 150 : 90;
  });
}

/// Chains of points in the pixels of a picture: '.' none, 'v' normal down, '^' up, '>' right.
std::vector<EdgePoint> drawn(const std::vector<std::string>& rows) {
  std::vector<EdgePoint> points;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      const char c = rows[y][x];
      if (c == '.') continue;
      EdgePoint point;
      point.x = static_cast<int>(x);
      point.y = static_cast<int>(y);
      point.pixel_px = Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y));
      point.normal = c == 'v'   ? Eigen::Vector2f(0, 1)
                     : c == '^' ? Eigen::Vector2f(0, -1)
                                : Eigen::Vector2f(1, 0);
      point.sigma_px = 0.05F;
      points.push_back(point);
    }
  }
  return points;
}

std::vector<std::size_t> lengths(const std::vector<EdgeChain>& chains) {
  std::vector<std::size_t> found;
  for (const EdgeChain& chain : chains) found.push_back(chain.points.size());
  std::sort(found.begin(), found.end());
  return found;
}

TEST(EdgeChains, FollowStairsAndCorners) {
  const auto points = drawn({"..........",  //
                             ".vv.......",  //
                             "...v......",  //
                             "...vv.....",  //
                             ".....vvvv."});
  const auto chains = edge_chains(points);
  ASSERT_EQ(lengths(chains), std::vector<std::size_t>{9});
  EXPECT_FALSE(chains[0].closed);
  for (std::size_t k = 0; k + 1 < 9; ++k) {
    const EdgePoint& one = points[static_cast<std::size_t>(chains[0].points[k])];
    const EdgePoint& next = points[static_cast<std::size_t>(chains[0].points[k + 1])];
    EXPECT_LE(std::max(std::abs(one.x - next.x), std::abs(one.y - next.y)), 1);
  }
}

TEST(EdgeChains, EndAtJunctionsButNotAtSpurs) {
  EXPECT_EQ(lengths(edge_chains(drawn({"...v....",  //
                                       "...v....",  //
                                       "...v....",  //
                                       "...v....",  //
                                       "vvvvvvvv"}))),
            (std::vector<std::size_t>{3, 4, 4}));
  EXPECT_EQ(lengths(edge_chains(drawn({"...v....",  //
                                       "...v....",  //
                                       "vvvvvvvv"}))),
            (std::vector<std::size_t>{2, 8}));
}

TEST(EdgeChains, CloseRoundARing) {
  const auto chains = edge_chains(drawn({".>>>.",  //
                                         ">...>",  //
                                         ">...>",  //
                                         ".>>>."}));
  ASSERT_EQ(lengths(chains), std::vector<std::size_t>{10});
  EXPECT_TRUE(chains[0].closed);
}

TEST(EdgeChains, DoNotStepToAnEdgeOfTheOtherSign) {
  EXPECT_EQ(lengths(edge_chains(drawn({"vvvvvv......",  //
                                       "......^^^^^^"}))),
            (std::vector<std::size_t>{6, 6}));
}

TEST(EdgeChains, HoldEveryPointOnceAtMost) {
  RandomStream draws({51});
  const auto polygon = test::random_polygon({80, 80}, draws);
  const auto points = canny_edges(test::with_noise(image_of(polygon, true), 12, draws));
  ASSERT_GT(points.size(), 400U);
  std::set<int> seen;
  for (const EdgeChain& chain : edge_chains(points)) {
    for (const int i : chain.points) EXPECT_TRUE(seen.insert(i).second) << i;
  }
  EXPECT_GT(static_cast<double>(seen.size()), 0.8 * static_cast<double>(points.size()));
}

/// What was recovered of rendered polygons.
struct Recovered {
  int sides = 0, found = 0, others = 0, ends = 0, corners = 0;
  double chi2 = 0, z2 = 0;
  std::vector<double> errors_px;
};

/// Adds an end of a segment along `side`, a unit vector, at a polygon's corner.
void add_end(const Eigen::Vector2d& end,
             const Eigen::Matrix2d& covariance,
             bool is_corner,
             const Eigen::Vector2d& truth,
             const Eigen::Vector2d& along,
             Recovered& recovered) {
  const Eigen::Vector2d error = end - truth, across(-along.y(), along.x());
  ++recovered.ends;
  recovered.z2 += std::pow(across.dot(error), 2) / across.dot(covariance * across);
  recovered.errors_px.push_back(error.norm());
  if (!is_corner) return;
  ++recovered.corners;
  recovered.chi2 += error.dot(covariance.inverse() * error);
}

void add(const std::vector<EdgeSegment>& segments,
         const test::ConvexPolygon& polygon,
         bool bright,
         Recovered& recovered) {
  const auto& corners = polygon.corners;
  recovered.sides += static_cast<int>(corners.size());
  std::set<std::size_t> found;
  for (const EdgeSegment& s : segments) {
    const Eigen::Vector2d middle = (s.segment.a_px + s.segment.b_px) / 2;
    bool is_side = false;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      // Clockwise, the inside is on the right: a bright polygon's segments run as its sides do.
      const Eigen::Vector2d from = corners[bright ? k : (k + 1) % corners.size()];
      const Eigen::Vector2d to = corners[bright ? (k + 1) % corners.size() : k];
      const Eigen::Vector2d along = (to - from).normalized(), across(-along.y(), along.x());
      if (std::abs(across.dot(middle - from)) > 1) continue;
      if (s.segment.length_px() < 0.5 * (to - from).norm()) continue;
      is_side = (s.segment.b_px - s.segment.a_px).normalized().dot(along) > 0.999;
      if (!is_side) continue;
      found.insert(k);
      add_end(s.segment.a_px, s.a_covariance_px2, s.a_is_corner, from, along, recovered);
      add_end(s.segment.b_px, s.b_covariance_px2, s.b_is_corner, to, along, recovered);
      break;
    }
    if (!is_side) ++recovered.others;
  }
  recovered.found += static_cast<int>(found.size());
}

Recovered recover(double noise, unsigned polygons) {
  Recovered recovered;
  for (unsigned trial = 0; trial < polygons; ++trial) {
    RandomStream draws({52, trial});
    const auto polygon =
        test::random_polygon({80 + draws.uniform(-0.5, 0.5), 80 + draws.uniform(-0.5, 0.5)}, draws);
    const bool bright = trial % 2 == 0;
    const auto points = canny_edges(test::with_noise(image_of(polygon, bright), noise, draws));
    add(edge_segments(points), polygon, bright, recovered);
  }
  std::sort(recovered.errors_px.begin(), recovered.errors_px.end());
  return recovered;
}

/// Every side once and nothing else, all ends at corners, and their errors as large as stated: the
/// mean χ² of two degrees of freedom over 210 corners (each is an end of two segments) has a
/// deviation of 0.14, the mean square across 210 ends one of 0.1.
TEST(EdgeSegments, RecoverThePolygonAndStateTheirEndsErrors) {
  const Recovered r = recover(2, 48);
  ASSERT_GT(r.sides, 180);
  EXPECT_EQ(r.found, r.sides);
  EXPECT_LE(r.others, 1);
  EXPECT_GE(r.corners, r.ends - 3);
  EXPECT_NEAR(r.chi2 / r.corners, 1.85, 0.45);
  EXPECT_NEAR(r.z2 / r.ends, 0.93, 0.3);
  EXPECT_LT(r.errors_px[r.errors_px.size() / 2], 0.035);
  EXPECT_LT(r.errors_px[r.errors_px.size() * 95 / 100], 0.1);
}

/// Without noise to speak of the errors shrink with it, until what is left of the corners'
/// rounding, 0.005 px, is more than what is stated.
TEST(EdgeSegments, AreAsExactAsTheImage) {
  const Recovered r = recover(0.4, 24);
  EXPECT_EQ(r.found, r.sides);
  EXPECT_LE(r.others, 1);
  EXPECT_LT(r.errors_px[r.errors_px.size() / 2], 0.012);
  EXPECT_LT(r.chi2 / r.corners, 5);
}

/// Five times the noise that a camera has: points err by 0.1 px, near to the threshold.
TEST(EdgeSegments, LoseLittleToStrongNoise) {
  const Recovered r = recover(5, 24);
  EXPECT_GE(r.found, r.sides - 2);
  EXPECT_NEAR(r.chi2 / r.corners, 1.85, 0.7);
}

TEST(EdgeSegments, ApproximateACurveWithinTheThreshold) {
  const auto image =
      test::photographed(segments_side, segments_side, 0.8, [](const Eigen::Vector2d& p) {
        return (p - Eigen::Vector2d(80.2, 79.7)).norm() < 60 ? 150 : 90;
      });
  const auto points = canny_edges(image);
  std::size_t on_segments = 0, previous = 0;
  for (const double most : {0.08, 0.15, 0.4}) {
    const auto segments = edge_segments(points, {.max_rms_px = most});
    on_segments = 0;
    for (const EdgeSegment& s : segments) {
      EXPECT_LE(s.rms_px, most);
      on_segments += s.points.size();
      for (const int i : s.points) {
        const Eigen::Vector2d d = (s.segment.b_px - s.segment.a_px).normalized();
        const Eigen::Vector2d to =
            points[static_cast<std::size_t>(i)].pixel_px.cast<double>() - s.segment.a_px;
        EXPECT_LE(std::abs(d.x() * to.y() - d.y() * to.x()), 4 * most);
      }
    }
    EXPECT_GT(static_cast<double>(on_segments), 0.85 * static_cast<double>(points.size()));
    if (previous > 0) {
      EXPECT_LT(segments.size(), previous);
    }
    previous = segments.size();
  }
}

TEST(EdgeSegments, ListTheirPointsInOrderAndEachPointOnce) {
  RandomStream draws({53});
  const auto polygon = test::random_polygon({80, 80}, draws);
  const auto points = canny_edges(test::with_noise(image_of(polygon, true), 6, draws));
  const auto segments = edge_segments(points);
  ASSERT_GT(segments.size(), 2U);
  std::set<int> seen;
  int previous = -1;
  for (const EdgeSegment& s : segments) {
    const Eigen::Vector2d d = (s.segment.b_px - s.segment.a_px).normalized();
    double before = -1e9;
    for (const int i : s.points) {
      EXPECT_TRUE(seen.insert(i).second);
      const EdgePoint& point = points[static_cast<std::size_t>(i)];
      const double along = d.dot(point.pixel_px.cast<double>());
      EXPECT_GT(along, before - 0.3);
      before = along;
      // The brighter side is on the right.
      EXPECT_GT(d.x() * point.normal.y() - d.y() * point.normal.x(), 0.5F);
    }
    const int first = std::min(s.points.front(), s.points.back());
    EXPECT_GT(first, previous);
    previous = first;
  }
}

/// Edges that end at another: short of it, by no more than three of the deviations stated, and well
/// known across.
TEST(EdgeSegments, EndShortOfAJunctionWithinWhatTheyState) {
  int stems = 0, within = 0;
  double z2 = 0;
  for (unsigned trial = 0; trial < 40; ++trial) {
    RandomStream draws({54, trial});
    const double turn = draws.uniform(0, 2 * pi), opening = draws.uniform(60, 90) * pi / 180;
    const Eigen::Vector2d at{40 + draws.uniform(-0.5, 0.5), 40 + draws.uniform(-0.5, 0.5)};
    const Eigen::Vector2d stem(std::cos(turn + opening), std::sin(turn + opening));
    const Eigen::Vector2d bar_normal(-std::sin(turn), std::cos(turn)), across(-stem.y(), stem.x());
    const auto clean = test::photographed(80, 80, 0.8, [&](const Eigen::Vector2d& p) {
      if (bar_normal.dot(p - at) < 0) return 60;
      return across.dot(p - at) < 0 ? 120 : 180;
    });
    for (const EdgeSegment& s : edge_segments(canny_edges(test::with_noise(clean, 2, draws)))) {
      const Eigen::Vector2d d = (s.segment.b_px - s.segment.a_px).normalized();
      const Eigen::Vector2d middle = (s.segment.a_px + s.segment.b_px) / 2 - at;
      if (std::abs(d.dot(stem)) < 0.99 || std::abs(across.dot(middle)) > 1) continue;
      if (s.segment.length_px() < 15) continue;
      const bool a = d.dot(stem) > 0;
      const Eigen::Vector2d error = (a ? s.segment.a_px : s.segment.b_px) - at;
      const Eigen::Matrix2d& covariance = a ? s.a_covariance_px2 : s.b_covariance_px2;
      ++stems;
      within += std::abs(stem.dot(error)) < 3 * std::sqrt(stem.dot(covariance * stem)) ? 1 : 0;
      z2 += std::pow(across.dot(error), 2) / across.dot(covariance * across);
    }
  }
  ASSERT_GE(stems, 39);
  EXPECT_GE(within, stems - 1);
  EXPECT_NEAR(z2 / stems, 1, 0.75);
}

TEST(EdgeSegments, AreNoneWhereThereAreNoEdges) {
  EXPECT_TRUE(edge_segments({}).empty());
  EXPECT_TRUE(edge_segments(drawn({"vvvvvvv"})).empty());  // fewer than eight points
  ASSERT_EQ(edge_segments(drawn({"vvvvvvvv"})).size(), 1U);
  EXPECT_EQ(edge_segments(drawn({"vvvvvvvv"}))[0].rms_px, 0);
  EXPECT_TRUE(edge_segments(canny_edges({50, 50, std::vector<float>(2500, 3)})).empty());
}

TEST(EdgeSegments, RefuseBadArguments) {
  auto points = drawn({"vvvvvvvvv"});
  const auto error = [&](const EdgeSegmentOptions& options) {
    return test::error_message([&] { edge_segments(points, options); });
  };
  EXPECT_NE(error({.max_rms_px = 0}).find("rms"), std::string::npos);
  EXPECT_NE(error({.min_points = 3}).find("4 points"), std::string::npos);
  EXPECT_NE(error({.scale_px = -1}).find("scale"), std::string::npos);
  std::swap(points[2], points[5]);
  EXPECT_NE(error({}).find("sorted"), std::string::npos);
  std::swap(points[2], points[5]);
  points[0].x = -4;
  EXPECT_NE(error({}).find("negative"), std::string::npos);
}

}  // namespace
}  // namespace vernier
