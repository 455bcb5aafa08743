// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Histograms determine the shape they were made of, up to what their type ignores (Thacker,
// Riocreux and Yates 1995): polygons are reconstructed from the bins.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "calib/statistics/random.h"
#include "localise/pgh.h"
#include "stereo/segment.h"
#include "tests/localise/shape_from_pgh.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::stereo;
using test::Shape;

namespace {

/// Bins of 0.25° and 0.5 px, blurred by less than a bin.
PghOptions fine(PghType type) {
  return {.type = type,
          .angle_bins = 360,
          .distance_bins = 440,
          .max_distance = 220,
          .angle_sigma_rad = 0.0013,
          .distance_sigma = 0.25,
          .max_weight_m = 1e9};
}

constexpr double bin_px = 0.5;

double undirected_angle(const ImageSegment& p, const ImageSegment& q) {
  const Eigen::Vector2d u = (p.b_px - p.a_px).normalized(), v = (q.b_px - q.a_px).normalized();
  return std::acos(std::min(1.0, std::abs(u.dot(v))));
}

/// Whether the extension of p cuts q near its middle.
bool cuts_middle(const ImageSegment& p, const ImageSegment& q) {
  const Eigen::Vector2d u = (p.b_px - p.a_px).normalized();
  const auto distance = [&](const Eigen::Vector2d& x) {
    return u.x() * (x - p.a_px).y() - u.y() * (x - p.a_px).x();
  };
  const double a = distance(q.a_px), b = distance(q.b_px);
  return std::abs(a + b) < 0.3 * std::max(std::abs(a), std::abs(b));
}

/// See shapes_from_histograms: angles of 8° to 86°, apart from each other.
bool in_general_position(const Shape& shape) {
  struct Pair {
    std::size_t i, j;
    double angle;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    for (std::size_t j = i + 1; j < shape.size(); ++j) {
      const double angle = undirected_angle(shape[i], shape[j]);
      if (angle < 0.14 || angle > 1.5) return false;
      if (cuts_middle(shape[i], shape[j]) || cuts_middle(shape[j], shape[i])) return false;
      for (const Pair& other : pairs) {
        const bool same_row = other.i == i || other.i == j || other.j == i || other.j == j;
        if (std::abs(other.angle - angle) < (same_row ? 0.035 : 0.012)) return false;
      }
      pairs.push_back({i, j, angle});
    }
  }
  return true;
}

/// A polygon of corners around a centre, not convex in general, in general position.
Shape random_polygon(std::uint64_t seed, int corners) {
  for (std::uint32_t attempt = 0;; ++attempt) {
    RandomStream d({.seed = seed, .trial = attempt});
    std::vector<double> bearings;
    for (int i = 0; i < corners; ++i) bearings.push_back(d.uniform(0, 2 * M_PI));
    std::sort(bearings.begin(), bearings.end());
    std::vector<Eigen::Vector2d> points;
    for (const double bearing : bearings) {
      const double radius = d.uniform(40, 100);
      points.emplace_back(320 + radius * std::cos(bearing), 240 + radius * std::sin(bearing));
    }
    Shape shape;
    for (int i = 0; i < corners; ++i) shape.push_back({points[i], points[(i + 1) % corners]});
    const bool long_enough =
        std::all_of(shape.begin(), shape.end(), [](const auto& s) { return s.length_px() > 15; });
    if (long_enough && in_general_position(shape)) return shape;
  }
}

bool is_convex(const Shape& shape) {
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const ImageSegment &p = shape[i], &q = shape[(i + 1) % shape.size()];
    const Eigen::Vector2d u = p.b_px - p.a_px, v = q.b_px - q.a_px;
    if (u.x() * v.y() - u.y() * v.x() < 0) return false;
  }
  return true;
}

/// Largest distance of an end from where it belongs, after the best motion, and reflection if
/// `reflect`. The order of ends counts if `ordered`.
double misplacement(const Shape& found, const Shape& truth, bool reflect, bool ordered) {
  const auto n = static_cast<Eigen::Index>(truth.size());
  Eigen::Matrix2Xd from(2, n), to(2, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    from.col(i) = 0.5 * (found[i].a_px + found[i].b_px);
    to.col(i) = 0.5 * (truth[i].a_px + truth[i].b_px);
  }
  const Eigen::Vector2d from_mean = from.rowwise().mean(), to_mean = to.rowwise().mean();
  from.colwise() -= from_mean;
  to.colwise() -= to_mean;
  if (reflect) from.row(1) *= -1;
  const double turn = std::atan2((from.row(0).dot(to.row(1)) - from.row(1).dot(to.row(0))),
                                 (from.row(0).dot(to.row(0)) + from.row(1).dot(to.row(1))));
  const auto moved = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    Eigen::Vector2d y = x - from_mean;
    if (reflect) y.y() = -y.y();
    return Eigen::Rotation2Dd(turn) * y + to_mean;
  };
  double worst = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector2d a = moved(found[i].a_px), b = moved(found[i].b_px);
    const auto off = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
      return std::max((p - truth[i].a_px).norm(), (q - truth[i].b_px).norm());
    };
    worst = std::max(worst, ordered ? off(a, b) : std::min(off(a, b), off(b, a)));
  }
  return worst;
}

double misplacement(const Shape& found, const Shape& truth, PghType type) {
  const double moved = misplacement(found, truth, false, type == PghType::directed);
  return type == PghType::mirror ? std::min(moved, misplacement(found, truth, true, false)) : moved;
}

std::vector<Shape> reconstructed(const Shape& shape, const PghOptions& options) {
  const Pgh pgh = image_histograms(shape, options);
  return test::shapes_from_histograms(plain_histograms(pgh), pgh.axes, options.type, 8 * bin_px);
}

class Completeness : public testing::TestWithParam<PghType> {};

/// There is a shape with these histograms, and all of them are the polygon.
TEST_P(Completeness, APolygonIsReconstructed) {
  double worst = 0;
  int concave = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Shape polygon = random_polygon(seed, 4 + static_cast<int>(seed % 3));
    concave += !is_convex(polygon);
    const std::vector<Shape> found = reconstructed(polygon, fine(GetParam()));
    EXPECT_FALSE(found.empty()) << seed;
    for (const Shape& shape : found) {
      const double off = misplacement(shape, polygon, GetParam());
      EXPECT_LT(off, 3 * bin_px) << seed;  // of lines at 8° or more, whose errors grow sevenfold
      worst = std::max(worst, off);
    }
  }
  EXPECT_GE(concave, 3);  // edges that cross others' lines
  RecordProperty("concave", concave);
  RecordProperty("worst_misplacement_px", std::to_string(worst));
}

/// A histogram of another polygon contradicts the others.
TEST_P(Completeness, AForeignHistogramLeavesNoShape) {
  const PghOptions options = fine(GetParam());
  const Pgh pgh = image_histograms(random_polygon(1, 5), options);
  const Pgh other = image_histograms(random_polygon(2, 5), options);
  HistogramRows rows = plain_histograms(pgh);
  rows.row(2) = plain_histograms(other).row(2);
  EXPECT_TRUE(test::shapes_from_histograms(rows, pgh.axes, GetParam(), 8 * bin_px).empty());
}

/// Neither axis alone determines the shape.
TEST_P(Completeness, NoShapeIsFoundWithoutAnAxis) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Shape polygon = random_polygon(seed, 5);
    PghOptions angles = fine(GetParam()), distances = fine(GetParam());
    angles.distance_bins = 1;
    distances.angle_bins = 1;
    for (const PghOptions& options : {angles, distances}) {
      EXPECT_TRUE(reconstructed(polygon, options).empty()) << seed;
    }
  }
}

/// Two shapes that differ, by the place of an edge, and have the same angles.
TEST_P(Completeness, AnglesAloneDoNotTellShapesApart) {
  const Shape polygon = random_polygon(3, 5);
  Shape shifted = polygon;
  shifted[1].a_px += Eigen::Vector2d(25, -10);
  shifted[1].b_px += Eigen::Vector2d(25, -10);
  ASSERT_GT(misplacement(shifted, polygon, GetParam()), 10);
  PghOptions options = fine(GetParam());
  const auto least_coefficient = [&] {
    const Pgh p = image_histograms(polygon, options), q = image_histograms(shifted, options);
    return p.rows.cwiseProduct(q.rows).rowwise().sum().minCoeff();
  };
  EXPECT_LT(least_coefficient(), 0.9);
  options.distance_bins = 1;
  if (GetParam() != PghType::directed) {  // whose single bin has a side
    EXPECT_GT(least_coefficient(), 0.9999);
  }
}

INSTANTIATE_TEST_SUITE_P(Types,
                         Completeness,
                         testing::Values(PghType::mirror, PghType::rotation, PghType::directed),
                         [](const auto& info) {
                           return std::string(info.param == PghType::mirror     ? "mirror"
                                              : info.param == PghType::rotation ? "rotation"
                                                                                : "directed");
                         });

}  // namespace
}  // namespace vernier
