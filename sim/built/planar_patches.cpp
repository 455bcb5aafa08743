// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/built/planar_patches.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "calib/base/plane_vectors.h"
#include "sim/built/depth_cloud.h"

namespace vernier::sim::internal {

using vernier::internal::cross;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Point = DepthCloud::Point;

/// Points' plane: x and y along it, z its normal.
struct Plane {
  Vector3d origin_m;
  Eigen::Matrix3d axes;
  double rms_m = 0;
};

Plane plane_of(std::span<const Point> points) {
  Vector3d sum = Vector3d::Zero();
  for (const Point& p : points) sum += p.at_m.cast<double>();
  Plane plane;
  plane.origin_m = sum / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Point& p : points) {
    const Vector3d d = p.at_m.cast<double>() - plane.origin_m;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread /
                                                              static_cast<double>(points.size()));
  plane.rms_m = std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
  const Vector3d n = solver.eigenvectors().col(0);
  // x along the floor, so that patches of walls border on each other
  const Vector3d level = Vector3d::UnitZ().cross(n);
  const Vector3d x =
      level.norm() > 0.1 ? level.normalized() : (Vector3d::UnitX() - n * n.x()).normalized();
  plane.axes << x, n.cross(x), n;
  return plane;
}

std::vector<Vector2d> in_plane(std::span<const Point> points, const Plane& plane) {
  std::vector<Vector2d> flat;
  for (const Point& p : points) {
    flat.emplace_back(plane.axes.leftCols<2>().transpose() *
                      (p.at_m.cast<double>() - plane.origin_m));
  }
  return flat;
}

/// The part of a convex polygon with n·p <= limit (Sutherland and Hodgman).
std::vector<Vector2d> cut(const std::vector<Vector2d>& polygon, const Vector2d& n, double limit) {
  std::vector<Vector2d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = n.dot(a) - limit, db = n.dot(b) - limit;
    if (da <= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + da / (da - db) * (b - a));
  }
  return kept;
}

/// The octagon around points, the outermost aside: 0.5 % in the directions of the axes, 0.1 % in
/// those between (1 % there would cut a seventh of a square's side off its corners); and a margin
/// for the distance between points.
std::vector<Vector2d> octagon(const std::vector<Vector2d>& points, double margin_m) {
  constexpr double far_m = 1e3;
  std::vector<Vector2d> polygon{{-far_m, -far_m}, {far_m, -far_m}, {far_m, far_m}, {-far_m, far_m}};
  std::vector<double> along(points.size());
  for (int k = 0; k < 8; ++k) {
    const double angle = k * std::numbers::pi / 4;
    const Vector2d n(std::cos(angle), std::sin(angle));
    std::transform(points.begin(), points.end(), along.begin(),
                   [&](const Vector2d& p) { return n.dot(p); });
    const std::size_t aside = along.size() / (k % 2 == 0 ? 200 : 1000);
    const auto at = along.begin() + static_cast<long>(along.size() - 1 - aside);
    std::nth_element(along.begin(), at, along.end());
    polygon = cut(polygon, n, *at + margin_m);
  }
  return polygon;
}

double area_of(const std::vector<Vector2d>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += cross(a, b);
  }
  return 0.5 * twice;
}

/// The area of the squares that have a point.
double filled_area(const std::vector<Vector2d>& points, double side_m) {
  std::set<std::pair<int, int>> squares;
  for (const Vector2d& p : points) {
    squares.emplace(std::floor(p.x() / side_m), std::floor(p.y() / side_m));
  }
  return static_cast<double>(squares.size()) * side_m * side_m;
}

/// Corners nearer to each other than 1 mm are one.
void join_corners(std::vector<Vector2d>& polygon) {
  std::vector<Vector2d> kept;
  for (const Vector2d& p : polygon) {
    if (kept.empty() || (kept.back() - p).norm() > 1e-3) kept.push_back(p);
  }
  while (kept.size() > 1 && (kept.back() - kept.front()).norm() <= 1e-3) kept.pop_back();
  polygon = std::move(kept);
}

class Divider {
 public:
  Divider(const DepthCloud& cloud, const PatchOptions& options) : cloud_(cloud), how_(options) {}

  void divide(std::span<Point> points, const Vector3d& low_m, double side_m) {
    if (static_cast<int>(points.size()) < how_.least_points) return;
    const Plane plane = plane_of(points);
    if (plane.rms_m <= how_.flat_m) {
      if (std::optional<Patch> patch = patch_of(points, plane, side_m)) {
        patches_.push_back(std::move(*patch));
        return;
      }
    }
    const double half_m = 0.5 * side_m;
    if (half_m < how_.smallest_m - 1e-9) return;
    halve(points, low_m, half_m, 0);
  }

  std::vector<Patch> take() { return std::move(patches_); }

 private:
  /// Divides by axis after axis, then on.
  void halve(std::span<Point> points, const Vector3d& low_m, double half_m, int axis) {
    if (axis == 3) return divide(points, low_m, half_m);
    const double border = low_m[axis] + half_m;
    const auto middle = std::stable_partition(
        points.begin(), points.end(), [&](const Point& p) { return p.at_m[axis] < border; });
    const auto first = static_cast<std::size_t>(middle - points.begin());
    halve(points.first(first), low_m, half_m, axis + 1);
    halve(points.subspan(first), low_m + half_m * Vector3d::Unit(axis), half_m, axis + 1);
  }

  std::optional<Patch> patch_of(std::span<const Point> points, const Plane& plane, double side_m) {
    std::set<int> views;
    Vector3d towards = Vector3d::Zero();
    for (const Point& p : points) {
      views.insert(p.view);
      towards += (cloud_.eyes_m()[p.view] - p.at_m.cast<double>()).normalized();
    }
    if (static_cast<int>(views.size()) < how_.least_views) return {};
    const std::vector<Vector2d> flat = in_plane(points, plane);
    std::vector<Vector2d> polygon = octagon(flat, 0.25 * how_.sample_m);
    join_corners(polygon);
    if (polygon.size() < 3) return {};
    const double area = area_of(polygon);
    // the last cells are taken as they are, unless they are slivers
    const bool is_last = 0.5 * side_m < how_.smallest_m - 1e-9;
    const double least = is_last ? 0.25 * side_m * side_m : 0;
    if (area < least || area < 1e-4) return {};
    if (!is_last && filled_area(flat, how_.sample_m) < how_.filled * area) return {};
    Patch patch;
    patch.views = static_cast<int>(views.size());
    patch.normal = plane.axes.col(2) * (plane.axes.col(2).dot(towards) < 0 ? -1 : 1);
    for (const Vector2d& p : polygon) {
      patch.polygon_m.push_back(plane.origin_m + plane.axes.leftCols<2>() * p);
    }
    return patch;
  }

  const DepthCloud& cloud_;
  PatchOptions how_;
  std::vector<Patch> patches_;
};

}  // namespace

std::vector<Patch> planar_patches(const DepthCloud& cloud, const PatchOptions& options) {
  std::vector<Point> points = cloud.points();
  const auto cell_of = [&](const Point& p) {
    std::array<int, 3> cell{};
    for (int k = 0; k < 3; ++k) {
      cell[k] = static_cast<int>(std::floor(p.at_m[k] / options.largest_m));
    }
    return cell;
  };
  std::stable_sort(points.begin(), points.end(),
                   [&](const Point& a, const Point& b) { return cell_of(a) < cell_of(b); });
  Divider divider(cloud, options);
  for (std::size_t first = 0, last = 0; first < points.size(); first = last) {
    const std::array<int, 3> cell = cell_of(points[first]);
    while (last < points.size() && cell_of(points[last]) == cell) ++last;
    const Vector3d low(cell[0], cell[1], cell[2]);
    divider.divide(std::span(points).subspan(first, last - first), options.largest_m * low,
                   options.largest_m);
  }
  return divider.take();
}

}  // namespace vernier::sim::internal
