// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/projection_difference.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/estimate/same_rig.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier::internal {
namespace {

/// Of the angle to the axis of a point that the alignment is fitted to, 80 degrees: it must not go
/// behind its camera on the way.
constexpr double least_cosine_in_focus = 0.1736;

/// A point as seen by a, homogeneous: w = 0 at infinity, where translations have no effect.
struct SeenPoint {
  int camera = 0;
  std::size_t map = 0, cell = 0;
  Eigen::Vector2d pixel;
  Eigen::Vector3d x_camera;  // in a's camera: metres, a unit direction at infinity
  Eigen::Vector3d x_first;   // in a's frame
  double w = 1;
  bool in_focus = false;
};

Eigen::Vector3d move(const Pose& T, const Eigen::Vector3d& x, double w) {
  return T.R * x + w * T.t;
}

std::vector<Eigen::Vector2d> grid_of(const Camera& camera, const Eigen::Vector2i& grid) {
  std::vector<Eigen::Vector2d> pixels;
  const Eigen::Vector2d last = (camera.size_px.array() - 1).cast<double>();
  for (int row = 0; row < grid[1]; ++row) {
    for (int column = 0; column < grid[0]; ++column) {
      pixels.emplace_back(grid[0] > 1 ? last[0] * column / (grid[0] - 1) : 0.5 * last[0],
                          grid[1] > 1 ? last[1] * row / (grid[1] - 1) : 0.5 * last[1]);
    }
  }
  return pixels;
}

/// Fills the headers of the maps and lists the points that both rigs can see.
std::vector<SeenPoint> points_of(const Rig& a,
                                 const Rig& b,
                                 const ProjectionDifferenceOptions& options,
                                 ProjectionDifference& result) {
  std::vector<SeenPoint> points;
  const Eigen::Vector2d nothing = Eigen::Vector2d::Constant(std::nan(""));
  for (std::size_t c = 0; c < a.cameras.size(); ++c) {
    result.pixels_px.push_back(grid_of(a.cameras[c], options.grid));
    const auto& pixels = result.pixels_px.back();
    const Pose T_first_camera = a.T_camera_first[c].inverse();
    const Eigen::Vector2d middle = 0.5 * (a.cameras[c].size_px.array() - 1).cast<double>();
    for (const double distance : options.distances_m) {
      const bool far = std::isinf(distance);
      DifferenceMap map;
      map.camera = static_cast<int>(c);
      map.distance_m = distance;
      map.before_px.assign(pixels.size(), nothing);
      map.after_px = map.before_px;
      for (std::size_t i = 0; i < pixels.size(); ++i) {
        SeenPoint p{static_cast<int>(c), result.maps.size(), i, pixels[i], {}, {}, far ? 0.0 : 1.0};
        p.in_focus =
            (pixels[i] - middle).norm() <= options.focus_share * middle.norm() * (1 + 1e-12);
        const auto ray = try_unproject(a.cameras[c], pixels[i]);
        if (ray) {
          p.in_focus = p.in_focus && ray->normalized().z() > least_cosine_in_focus;
          p.x_camera = ray->normalized() * (far ? 1 : distance);
          p.x_first = move(T_first_camera, p.x_camera, p.w);
        }
        if (ray && move(b.T_camera_first[c], p.x_first, p.w).z() > 0) {
          points.push_back(p);
        } else {
          ++result.left_out;
        }
      }
      result.maps.push_back(std::move(map));
    }
  }
  return points;
}

Eigen::Vector3d in_camera(const Rig& b, const Pose& T_b_a, const SeenPoint& p) {
  return move(b.T_camera_first[p.camera], move(T_b_a, p.x_first, p.w), p.w);
}

/// e over all points; empty if one of them is behind its camera.
Eigen::VectorXd misses(const Rig& b, const Pose& T_b_a, const std::vector<SeenPoint>& points) {
  Eigen::VectorXd e(2 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SeenPoint& p = points[i];
    const Eigen::Vector3d x = in_camera(b, T_b_a, p);
    if (!(x.z() > 0)) return {};
    e.segment<2>(2 * static_cast<Eigen::Index>(i)) = project(b.cameras[p.camera], x) - p.pixel;
  }
  return e;
}

/// de / d(left tangent of T_b_a).
Eigen::MatrixXd by_alignment(const Rig& b,
                             const Pose& T_b_a,
                             const std::vector<SeenPoint>& points) {
  Eigen::MatrixXd G(2 * static_cast<Eigen::Index>(points.size()), 6);
  ProjectionJacobian J;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SeenPoint& p = points[i];
    project(b.cameras[p.camera], in_camera(b, T_b_a, p), J);
    const Eigen::Matrix<double, 2, 3> by_x = J.point * b.T_camera_first[p.camera].R;
    const auto row = 2 * static_cast<Eigen::Index>(i);
    G.block<2, 3>(row, 0) = -by_x * hat(T_b_a.R * p.x_first);
    G.block<2, 3>(row, 3) = p.w * by_x;
  }
  return G;
}

/// de / d(tangent of the rig) for points fixed in space: `T` maps them to the rig's frame.
Eigen::MatrixXd by_rig(const Rig& rig, const Pose& T, const std::vector<SeenPoint>& points) {
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(2 * static_cast<Eigen::Index>(points.size()), parameter_count(rig));
  ProjectionJacobian J;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SeenPoint& p = points[i];
    const Eigen::Vector3d x = move(T, p.x_first, p.w);
    project(rig.cameras[p.camera], move(rig.T_camera_first[p.camera], x, p.w), J);
    const auto row = 2 * static_cast<Eigen::Index>(i);
    out.block(row, intrinsics_index(rig, p.camera), 2, J.camera.cols()) = J.camera;
    if (p.camera == 0) continue;
    const int pose = pose_index(rig, p.camera);
    out.block<2, 3>(row, pose) = -J.point * hat(rig.T_camera_first[p.camera].R * x);
    out.block<2, 3>(row, pose + 3) = p.w * J.point;
  }
  return out;
}

/// The points used to fit the alignment.
std::vector<SeenPoint> focus_of(const std::vector<SeenPoint>& points) {
  std::vector<SeenPoint> chosen;
  std::copy_if(points.begin(), points.end(), std::back_inserter(chosen),
               [](const SeenPoint& p) { return p.in_focus; });
  return chosen;
}

/// Those at several distances count once.
std::size_t distinct_pixels(const std::vector<SeenPoint>& points) {
  std::set<std::pair<int, std::size_t>> pixels;
  for (const SeenPoint& p : points) pixels.emplace(p.camera, p.cell);
  return pixels.size();
}

using Decomposition = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;

/// G with its translations scaled by the nearest distance, so that its rank does not depend on
/// units; the minimum-norm solution leaves undetermined directions unchanged (a translation, if all
/// points are at infinity).
struct ScaledAlignment {
  Eigen::Matrix<double, 6, 1> scale;
  Decomposition G;

  ScaledAlignment(const Eigen::MatrixXd& derivative, double nearest_m) {
    scale << 1, 1, 1, nearest_m, nearest_m, nearest_m;
    G.setThreshold(1e-10);
    G.compute(derivative * scale.asDiagonal());
  }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& e) const { return scale.asDiagonal() * G.solve(e); }
};

double nearest(const ProjectionDifferenceOptions& options) {
  double least = std::numeric_limits<double>::infinity();
  for (const double d : options.distances_m) least = std::min(least, d);
  return std::isinf(least) ? 1 : least;
}

/// Gauss–Newton, each step halved until the cost falls.
Pose align(const Rig& b, const std::vector<SeenPoint>& points, double nearest_m) {
  Pose T_b_a;
  Eigen::VectorXd e = misses(b, T_b_a, points);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const ScaledAlignment fit(by_alignment(b, T_b_a, points), nearest_m);
    Eigen::Matrix<double, 6, 1> step = -fit.solve(e);
    bool better = false;
    for (int halving = 0; halving < 30 && !better; ++halving, step *= 0.5) {
      const Pose tried = retract(T_b_a, step);
      const Eigen::VectorXd e_tried = misses(b, tried, points);
      better = e_tried.size() > 0 && e_tried.squaredNorm() < e.squaredNorm();
      if (!better) continue;
      T_b_a = tried;
      e = e_tried;
    }
    if (!better || step.norm() < 1e-12) break;
  }
  return T_b_a;
}

DifferenceSize size_of(const std::vector<Eigen::Vector2d>& e) {
  DifferenceSize size;
  double n = 0, squares = 0;
  for (const Eigen::Vector2d& v : e) {
    if (!v.allFinite()) continue;
    ++n;
    size.mean_px += v.norm();
    squares += v.squaredNorm();
    size.max_px = std::max(size.max_px, v.norm());
  }
  if (n > 0) {
    size.mean_px /= n;
    size.rms_px = std::sqrt(squares / n);
  }
  return size;
}

std::vector<Eigen::Vector2d> vectors(const Eigen::VectorXd& e) {
  std::vector<Eigen::Vector2d> list;
  for (Eigen::Index i = 0; i + 1 < e.size(); i += 2) list.emplace_back(e.segment<2>(i));
  return list;
}

void write_differences(const Rig& b,
                       const std::vector<SeenPoint>& points,
                       ProjectionDifference& result) {
  const Eigen::VectorXd before = misses(b, Pose{}, points);
  const Eigen::VectorXd after = misses(b, result.T_b_a, points);
  std::vector<Eigen::Vector2d> all_focus;
  std::vector<std::vector<Eigen::Vector2d>> focus(result.maps.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SeenPoint& p = points[i];
    const auto row = 2 * static_cast<Eigen::Index>(i);
    result.maps[p.map].before_px[p.cell] = before.segment<2>(row);
    result.maps[p.map].after_px[p.cell] = after.segment<2>(row);
    if (!p.in_focus) continue;
    focus[p.map].emplace_back(after.segment<2>(row));
    all_focus.push_back(focus[p.map].back());
  }
  for (std::size_t m = 0; m < result.maps.size(); ++m) {
    DifferenceMap& map = result.maps[m];
    map.before = size_of(map.before_px);
    map.after = size_of(map.after_px);
    map.in_focus = size_of(focus[m]);
  }
  result.before = size_of(vectors(before));
  result.after = size_of(vectors(after));
  result.in_focus = size_of(all_focus);
}

/// Mean of variances; square root at the end.
struct MeanVariance {
  double sum = 0, count = 0;
  void add(double variance) {
    sum += variance;
    ++count;
  }
  double root() const { return count > 0 ? std::sqrt(sum / count) : 0; }
};

void write_expected(const Eigen::VectorXd& variance,
                    const std::vector<SeenPoint>& points,
                    ProjectionDifference& result) {
  for (DifferenceMap& map : result.maps) map.expected_px.assign(map.after_px.size(), std::nan(""));
  std::vector<MeanVariance> all(result.maps.size()), focus(result.maps.size());
  MeanVariance total;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SeenPoint& p = points[i];
    const double v = variance.segment<2>(2 * static_cast<Eigen::Index>(i)).sum();
    result.maps[p.map].expected_px[p.cell] = std::sqrt(v);
    all[p.map].add(v);
    if (p.in_focus) focus[p.map].add(v);
    total.add(v);
  }
  for (std::size_t m = 0; m < result.maps.size(); ++m) {
    result.maps[m].expected_rms_px = all[m].root();
    result.maps[m].expected_in_focus_px = focus[m].root();
  }
  result.expected_rms_px = total.root();
}

/// diag of M C Mᵀ.
Eigen::VectorXd row_variances(const Eigen::MatrixXd& M, const Eigen::MatrixXd& C) {
  return (M * C).cwiseProduct(M).rowwise().sum();
}

void check(const ProjectionDifferenceOptions& options) {
  if (options.distances_m.empty()) throw Error("distances", "none is given", "give at least one");
  for (const double d : options.distances_m) {
    if (!(d > 0)) throw Error("distances", "one is not above 0", "give metres, or inf");
  }
  if (options.grid.minCoeff() < 1) {
    throw Error("grid", "it has no pixels", "give at least one column and one row");
  }
  if (!(options.focus_share > 0)) {
    throw Error("focus", "its fraction of the image is not above 0", "give a number in (0, 1]");
  }
}

}  // namespace

ProjectionDifference projection_difference(const Rig& a,
                                           const Rig& b,
                                           const ProjectionDifferenceOptions& options,
                                           const Covariance* covariance_a,
                                           const Covariance* covariance_b) {
  check_same_cameras(a, b, "second rig");
  check(options);
  ProjectionDifference result;
  std::vector<SeenPoint> points = points_of(a, b, options, result);
  const std::vector<SeenPoint> focus = focus_of(points);
  if (distinct_pixels(focus) < 6) {
    throw Error("projection difference",
                "fewer than 6 pixels of the focus have a ray in one rig, within 80 degrees of its "
                "axis, and an image in the other",
                "give a finer grid or a wider focus, or check that the rigs face the same way");
  }
  const double nearest_m = nearest(options);
  result.T_b_a = align(b, focus, nearest_m);
  // points outside the focus, as those of a fisheye near 90 degrees
  result.left_out += static_cast<int>(std::erase_if(
      points, [&](const SeenPoint& p) { return !(in_camera(b, result.T_b_a, p).z() > 0); }));
  write_differences(b, points, result);
  if (covariance_a && covariance_b) {
    const Eigen::MatrixXd G = by_alignment(b, result.T_b_a, points);
    const ScaledAlignment fit(by_alignment(b, result.T_b_a, focus), nearest_m);
    const auto left_by_alignment = [&](const Rig& rig, const Pose& T, const Covariance& C) {
      const Eigen::MatrixXd J = by_rig(rig, T, points);
      return row_variances(J - G * fit.solve(by_rig(rig, T, focus)), C.matrix);
    };
    write_expected(left_by_alignment(a, Pose{}, *covariance_a) +
                       left_by_alignment(b, result.T_b_a, *covariance_b),
                   points, result);
  }
  return result;
}

}  // namespace vernier::internal
