// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/join/point_scales.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include "localise/join/line_fit.h"
#include "localise/joined_lines.h"

namespace vernier::localise::internal {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Matrix42 = Eigen::Matrix<double, 4, 2>;

constexpr std::size_t fewest_views = 10;

/// D: of both ends across the line, by the scale of the whole point and by that of x and y. At the
/// points of the fitted line: at those measured, D has the noise of the residuals, and what motion
/// does not tell seems to be told by it.
Matrix42 by_scales(const SightedSegment& segment,
                   const Eigen::Matrix3d& R,
                   const LineFrame& frame,
                   const Vector4d& off_m) {
  Matrix42 D;
  int row = 0;
  for (const Vector3d& measured_m : {segment.a_m, segment.b_m}) {
    const Vector3d off = frame.axes.leftCols<2>() * off_m.segment<2>(row);
    const Vector3d p = measured_m - R.transpose() * off;
    const Vector3d across(p.x(), p.y(), 0);
    D.block<2, 1>(row, 0) = frame.axes.leftCols<2>().transpose() * (R * p);
    D.block<2, 1>(row, 1) = frame.axes.leftCols<2>().transpose() * (R * across);
    row += 2;
  }
  return D;
}

/// What the sightings of one view say: I and the score.
struct OfView {
  Matrix2d information = Matrix2d::Zero();
  Vector2d score = Vector2d::Zero();
};

/// What the sightings of all lines say, line by line.
class Sums {
 public:
  void add(std::span<const SegmentsOfView> views,
           const JoinedLine& line,
           const JoinOptions& options) {
    std::vector<WorldSighting> sightings;
    for (const LineSighting& s : line.sightings) {
      sightings.push_back(in_world(segment_of(views, s), views[s.view].T_world_camera, options));
      sightings.back().view = s.view;
      make_definite(sightings.back());
    }
    std::vector<const WorldSighting*> all;
    for (const WorldSighting& s : sightings) all.push_back(&s);
    const FittedLine fit = fitted(all);
    std::vector<LineMeasurement> m;
    std::vector<Matrix42> D;
    Matrix42 pull = Matrix42::Zero();
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      m.push_back(measured(sightings[k], fit.frame));
      D.push_back(by_scales(segment_of(views, line.sightings[k]),
                            views[sightings[k].view].T_world_camera.R, fit.frame, m[k].across_m));
      pull += m[k].by_line().transpose() * m[k].covariance_m2.llt().solve(D.back());
    }
    const Matrix42 moves = fit.covariance * pull;  // of the line by the scales
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      const Matrix42 E = D[k] - m[k].by_line() * moves;
      const Eigen::LLT<Matrix4d> C(m[k].covariance_m2);
      OfView& view = of_views_[sightings[k].view];
      view.information += E.transpose() * C.solve(E);
      view.score += E.transpose() * C.solve(m[k].across_m);
    }
  }

  std::optional<PointScales> result() const {
    if (of_views_.size() < fewest_views) return {};
    OfView all;
    for (const auto& [number, view] : of_views_) {
      all.information += view.information;
      all.score += view.score;
    }
    const Matrix2d& I = all.information;
    if (!(I.determinant() > 1e-9 * I(0, 0) * I(1, 1))) return {};
    const Matrix2d inverse = I.inverse();
    const Vector2d x = -inverse * all.score;
    Matrix2d scatter = Matrix2d::Zero();
    for (const auto& [number, view] : of_views_) {
      const Vector2d left = view.score + view.information * x;
      scatter += left * left.transpose();
    }
    const auto n = static_cast<double>(of_views_.size());
    const Matrix2d covariance = n / (n - 1) * inverse * scatter * inverse;
    PointScales found;
    found.depth = x[0];
    found.across = x[1];
    found.depth_sigma = std::sqrt(covariance(0, 0));
    found.across_sigma = std::sqrt(covariance(1, 1));
    return found;
  }

 private:
  static const SightedSegment& segment_of(std::span<const SegmentsOfView> views,
                                          const LineSighting& s) {
    return views[static_cast<std::size_t>(s.view)].segments[static_cast<std::size_t>(s.segment)];
  }

  std::map<int, OfView> of_views_;
};

/// The views with the points of their segments multiplied by these scales.
std::vector<SegmentsOfView> scaled_views(std::span<const SegmentsOfView> views, const Vector2d& x) {
  const double depth = 1 + x[0], across = depth + x[1];
  Eigen::Matrix<double, 6, 1> by;
  by << across, across, depth, across, across, depth;
  std::vector<SegmentsOfView> scaled(views.begin(), views.end());
  for (SegmentsOfView& view : scaled) {
    for (SightedSegment& s : view.segments) {
      s.a_m = by.head<3>().cwiseProduct(s.a_m);
      s.b_m = by.head<3>().cwiseProduct(s.b_m);
      s.covariance_m2 = (by.asDiagonal() * s.covariance_m2 * by.asDiagonal()).eval();
    }
  }
  return scaled;
}

}  // namespace

std::optional<PointScales> point_scales(std::span<const SegmentsOfView> views,
                                        const JoinedLines& joined,
                                        const JoinOptions& options) {
  Sums sums;
  for (const JoinedLine& line : joined.lines) {
    if (line.views > 1) sums.add(views, line, options);
  }
  return sums.result();
}

PointScales joined_point_scales(std::span<const SegmentsOfView> views,
                                const PointScales& first,
                                const JoinOptions& options) {
  constexpr int most_joins = 5;
  constexpr double settled = 5e-4, first_factor = 4, most_factor = 8, most = 0.2;
  Vector2d x = Vector2d::Zero(), gain(first_factor, first_factor);
  PointScales at = first;
  for (int join = 0; join < most_joins; ++join) {
    const Vector2d left(at.tells_depth() ? at.depth : 0, at.tells_across() ? at.across : 0);
    const Vector2d step = gain.cwiseProduct(left);
    if (step.cwiseAbs().maxCoeff() < settled) break;
    const Vector2d next = (x + step).cwiseMax(-most).cwiseMin(most);
    const std::vector<SegmentsOfView> scaled = scaled_views(views, next);
    const auto found = point_scales(scaled, join_lines(scaled, options), options);
    if (!found) break;
    const Vector2d gone = left - Vector2d(found->depth, found->across);
    for (int i = 0; i < 2; ++i) {
      const double secant = std::abs(gone[i]) > 0 ? (next[i] - x[i]) / gone[i] : first_factor;
      gain[i] = std::clamp(secant, 1.0, most_factor);
    }
    x = next;
    at = *found;
  }
  at.depth += x[0];
  at.across += x[1];
  at.joined_again = true;
  return at;
}

}  // namespace vernier::localise::internal
