// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Rendered planes through Canny, the matcher with its own σ, segments and space.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "calib/statistics/distributions.h"
#include "stereo/canny_edges.h"
#include "stereo/edge_matcher.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"
#include "stereo/rectification.h"
#include "tests/support/leaf_pair.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

/// Side by side, f 500 px, 0.1 m.
RectifiedGeometry geometry_of(const test::LeafPlane& plane) {
  RectifiedGeometry g;
  g.turn = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
  g.f_px = 500;
  g.baseline_m = 0.1;
  g.centre_px = {150, 110};
  g.size_px = {plane.width_px, plane.height_px};
  return g;
}

/// q with q·p = B for the points p of the plane: d = d_0 + d_x (u − w/2) + d_y (v − h/2), times
/// z / f.
Eigen::Vector3d plane_in_space(const test::LeafPlane& plane, const RectifiedGeometry& g) {
  return {plane.by_x, plane.by_y, plane.disparity_at(g.centre_px.x(), g.centre_px.y()) / g.f_px};
}

/// What the segments say of the plane.
struct PlaneFigures {
  int segments = 0, wrong = 0;
  double z_squares = 0;   ///< of both ends' distance from it, mean
  double below_95 = 0;    ///< share of segments
  double plane_nees = 0;  ///< of the plane fitted to all, 3 degrees of freedom; mean of the pairs
};

PlaneFigures figures(test::LeafPlane plane, int pairs) {
  PlaneFigures f;
  const double first = plane.disparity_px;
  for (int k = 0; k < pairs; ++k) {
    plane.disparity_px = first + 0.37 * k;
    const RectifiedPair pair = test::leaf_pair(plane, 700 + static_cast<std::uint64_t>(k));
    const RectifiedGeometry g = geometry_of(plane);
    const Eigen::Vector3d truth = plane_in_space(plane, g);
    const std::vector<EdgePoint> edges = canny_edges(pair.left);
    const auto found = edge_matcher({.sigma_floor_px = 0})
                           .match(pair, edges, {0, static_cast<int>(plane.disparity_px) + 40});
    const auto lines = segment_disparities(edges, edge_segments(edges), found, {.floor_px = 0});
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const MeasuredSegment& s : space_segments(lines, g)) {
      if (s.status != SegmentStatus::placed) continue;
      Eigen::Matrix<double, 2, 3> ends;
      ends << s.segment.a_m.transpose(), s.segment.b_m.transpose();
      Eigen::Matrix<double, 2, 6> J = Eigen::Matrix<double, 2, 6>::Zero();
      J.block<1, 3>(0, 0) = J.block<1, 3>(1, 3) = truth.transpose();
      const Eigen::Matrix2d C = J * s.independent_m2 * J.transpose(), W = C.inverse();
      const Eigen::Vector2d off = ends * truth - Eigen::Vector2d::Constant(g.baseline_m);
      const double z2 = off.dot(W * off);
      ++f.segments;
      if (z2 > 40) {
        ++f.wrong;
        continue;
      }
      f.z_squares += z2 / 2;
      f.below_95 += z2 < chi_squared_quantile(0.95, 2);
      information += ends.transpose() * W * ends;
      sum += ends.transpose() * W * Eigen::Vector2d::Constant(g.baseline_m);
    }
    const Eigen::Vector3d e = information.ldlt().solve(sum) - truth;
    f.plane_nees += e.dot(information * e) / pairs;
  }
  f.z_squares /= f.segments - f.wrong;
  f.below_95 /= f.segments - f.wrong;
  return f;
}

/// 180 segments a pair. The mean plane_nees of 8 pairs is χ² of 24 over 8 if the stated covariances
/// are right and segments independent: the upper bound has a false-alarm rate of 1e-3. They state
/// too much, mostly, by up to 1.5 in variance (docs/segments3d.md), which the lower bounds allow.
TEST(SpaceSegmentsOfPlanes, GiveThePlaneBack) {
  for (const auto& [by_x, by_y] : {std::pair{0.0, 0.0}, {0.15, 0.0}, {0.0, 0.2}, {-0.1, 0.1}}) {
    const PlaneFigures f =
        figures({.disparity_px = 30, .by_x = by_x, .by_y = by_y, .min_radius_px = 12}, 8);
    SCOPED_TRACE(testing::Message() << by_x << ' ' << by_y);
    EXPECT_GT(f.segments, 1200);
    EXPECT_LE(f.wrong, 2);
    EXPECT_GT(f.z_squares, 0.45);
    EXPECT_LT(f.z_squares, 1.2);
    EXPECT_GT(f.below_95, 0.91);
    EXPECT_LT(f.plane_nees, chi_squared_quantile(0.999, 24) / 8);
    EXPECT_GT(f.plane_nees, 0.5);
  }
}

}  // namespace
}  // namespace vernier
