// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/reconstruction/segment_disparity.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "calib/error.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_line.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/matcher.h"
#include "stereo/reconstruction/disparity_line.h"

namespace vernier::stereo::internal {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double patch_width_px = 9,
                 patch_height_px = 7;     // of stereo/matching/disparity_refinement.h
constexpr double max_moved_alike = 0.95;  // of the limit at which the covariance stays positive

/// A segment with the data of its points.
struct Edge {
  const EdgeSegment& segment;
  EdgeLine line;
  double length_px;
  std::vector<double> along_px;  ///< of every point, from a

  Edge(const std::vector<EdgePoint>& edges, const EdgeSegment& s, double scale_px)
      : segment(s), line(edges, s.points, scale_px), length_px(s.segment.length_px()) {
    for (const int p : s.points) {
      const EdgePoint& point = edges[static_cast<std::size_t>(p)];
      along_px.push_back(line.direction.dot(Vector2d(point.row_x_px, point.y) - s.segment.a_px));
    }
  }

  /// Relative to the line's own origin.
  double from_centroid(double along) const { return line.along(segment.segment.a_px) + along; }
};

std::vector<DisparitySample> samples_of(const Edge& edge,
                                        const std::vector<EdgeDisparity>& disparities,
                                        const SegmentDisparityOptions& o) {
  std::vector<DisparitySample> samples;
  for (std::size_t i = 0; i < edge.along_px.size(); ++i) {
    const int point = edge.segment.points[i];
    const EdgeDisparity& found = disparities[static_cast<std::size_t>(point)];
    if (!found.matched()) continue;
    const bool stated = found.sigma_px > 0 && std::isfinite(found.sigma_px);
    const double sigma = stated ? found.sigma_px : o.unstated_sigma_px;
    samples.push_back({edge.along_px[i], found.disparity_px, sigma,
                       stated ? std::min(o.floor_px, sigma) : sigma, point});
  }
  std::stable_sort(samples.begin(), samples.end(),
                   [](const auto& a, const auto& b) { return a.along_px < b.along_px; });
  return samples;
}

/// One end of a part: its position along the segment and in the image.
struct SegmentEnd {
  double along_px = 0;
  Vector2d place;
  Matrix2d covariance;
  bool own = true;  ///< that of the segment
};

SegmentEnd end_of(const Edge& edge,
                  bool is_a,
                  double outermost_px,
                  const SegmentDisparityOptions& o) {
  const EdgeSegment& s = edge.segment;
  const double own = is_a ? 0 : edge.length_px;
  if (std::abs(own - outermost_px) <= o.reach_px) {
    return {own, is_a ? s.segment.a_px : s.segment.b_px,
            is_a ? s.a_covariance_px2 : s.b_covariance_px2, true};
  }
  const double at = edge.from_centroid(outermost_px);
  const Vector2d &n = edge.line.normal, &t = edge.line.direction;
  return {outermost_px, edge.line.at(at),
          edge.line.across_variance(at) * n * n.transpose() +
              o.end_sigma_px * o.end_sigma_px * t * t.transpose(),
          false};
}

/// The covariance of both ends' positions and disparities
/// (stereo/reconstruction/segment_disparity.h).
class EndCovariance {
 public:
  EndCovariance(const Edge& edge,
                const DisparityLine& line,
                const SegmentEnd& a,
                const SegmentEnd& b,
                double moved_alike)
      : t_(edge.line.direction), slope_(line.slope()) {
    const Vector2d& n = edge.line.normal;
    const auto row = [&](const SegmentEnd& end) {
      return Vector2d(1, edge.from_centroid(end.along_px));
    };
    across_ << row(a), row(b);
    across_ = (across_.transpose() * edge.line.covariance * across_).eval();
    disparity_ << line.covariance_of(a.along_px, a.along_px),
        line.covariance_of(a.along_px, b.along_px), line.covariance_of(b.along_px, a.along_px),
        line.covariance_of(b.along_px, b.along_px);
    ends_ = {a.covariance, b.covariance};
    // Displacement of an end when its line moves by 1 across.
    by_across_ = {a.covariance * n / n.dot(a.covariance * n),
                  b.covariance * n / n.dot(b.covariance * n)};
    alike_ = moved_alike == 0 ? 0 : alike(moved_alike, std::abs(n.x())) * (n.x() < 0 ? -1 : 1);
  }

  Eigen::Matrix<double, 6, 6> matrix() const {
    Eigen::Matrix<double, 6, 6> C = Eigen::Matrix<double, 6, 6>::Zero();
    for (int i = 0; i < 2; ++i) C.block<2, 2>(2 * i, 2 * i) = ends_[i];
    C.block<2, 2>(0, 2) = across_(0, 1) * by_across_[0] * by_across_[1].transpose();
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        C.block<2, 1>(2 * i, 4 + j) = alike_ * across_(i, j) * by_across_[i];
      }
    }
    C.bottomRightCorner<2, 2>() = disparity_;
    Eigen::Matrix<double, 6, 6> slide = Eigen::Matrix<double, 6, 6>::Identity();
    for (int i = 0; i < 2; ++i) slide.block<1, 2>(4 + i, 2 * i) = slope_ * t_.transpose();
    const Eigen::Matrix<double, 6, 6> whole = C.selfadjointView<Eigen::Upper>();
    return slide * whole * slide.transpose();
  }

 private:
  /// Change of the disparity when the line moves by 1 across; less if the disparity is too accurate
  /// for it.
  double alike(double moved_alike, double n_x) const {
    const Matrix2d root = across_.llt().matrixL();
    const Matrix2d inverse = root.inverse();
    const Eigen::SelfAdjointEigenSolver<Matrix2d> ratio(inverse * disparity_ * inverse.transpose());
    const double most = max_moved_alike * std::sqrt(std::max(0.0, ratio.eigenvalues()[0]));
    return std::isfinite(most) ? std::min(moved_alike / n_x, most) : 0;
  }

  Vector2d t_;
  double slope_, alike_ = 0;
  Matrix2d across_, disparity_;
  std::array<Matrix2d, 2> ends_;
  std::array<Vector2d, 2> by_across_;
};

/// One part of a segment; nullopt if its inliers are too sparse.
SegmentDisparity part_of(const Edge& edge,
                         const DisparityLine& line,
                         const SegmentDisparityOptions& options) {
  const SegmentEnd a = end_of(edge, true, line.samples.front().along_px, options);
  const SegmentEnd b = end_of(edge, false, line.samples.back().along_px, options);
  SegmentDisparity part;
  part.is_part = !a.own || !b.own;
  part.left_px = {a.place, b.place};
  part.a_disparity_px = line.at(a.along_px);
  part.b_disparity_px = line.at(b.along_px);
  part.disparity_noise_px2 = {line.noise_variance(a.along_px), line.noise_variance(b.along_px)};
  part.covariance_px2 = EndCovariance(edge, line, a, b, options.moved_alike).matrix();
  part.rms_px = line.rms_px;
  for (const DisparitySample& s : line.samples) part.points.push_back(s.point);
  const auto within = [&](double s) { return s >= a.along_px - 1 && s <= b.along_px + 1; };
  part.edge_points =
      static_cast<int>(std::count_if(edge.along_px.begin(), edge.along_px.end(), within));
  return part;
}

DisparityLineOptions line_options(const Edge& edge, const SegmentDisparityOptions& o) {
  const Vector2d t = edge.line.direction.cwiseAbs();
  return {o.min_points, o.max_off_sigma,
          std::min(patch_height_px / std::max(t.y(), 1e-9), patch_width_px / std::max(t.x(), 1e-9)),
          o.floor_length_px};
}

/// All parts of one segment, or one entry with the reason for rejection.
std::vector<SegmentDisparity> parts_of(const std::vector<EdgePoint>& edges,
                                       const EdgeSegment& segment,
                                       const std::vector<EdgeDisparity>& disparities,
                                       const SegmentDisparityOptions& options) {
  SegmentDisparity refused;
  refused.left_px = segment.segment;
  refused.edge_points = static_cast<int>(segment.points.size());
  const Vector2d along = segment.segment.b_px - segment.segment.a_px;
  if (std::abs(along.y()) < std::sin(options.min_angle_rad) * along.norm()) {
    refused.status = SegmentStatus::along_row;
    return {refused};
  }
  const Edge edge(edges, segment, options.scale_px);
  const auto samples = samples_of(edge, disparities, options);
  std::vector<SegmentDisparity> parts;
  bool sparse = static_cast<int>(samples.size()) < options.min_points;
  for (const DisparityLine& line : disparity_lines(samples, line_options(edge, options))) {
    SegmentDisparity part = part_of(edge, line, options);
    if (static_cast<double>(part.points.size()) < options.min_share * part.edge_points) {
      sparse = true;
      continue;
    }
    parts.push_back(std::move(part));
  }
  if (!parts.empty()) return parts;
  refused.status = sparse ? SegmentStatus::unmatched : SegmentStatus::disagree;
  return {refused};
}

void check(const std::vector<EdgePoint>& edges,
           const std::vector<EdgeSegment>& segments,
           const std::vector<EdgeDisparity>& disparities,
           const SegmentDisparityOptions& o) {
  const std::string place = "segment disparities";
  if (edges.size() != disparities.size()) {
    throw Error(place, "edges and disparities differ in number", "give one disparity per edge");
  }
  const auto is_none = [&](int p) { return p < 0 || p >= static_cast<int>(edges.size()); };
  for (const EdgeSegment& s : segments) {
    if (s.points.size() < 2 || std::any_of(s.points.begin(), s.points.end(), is_none)) {
      throw Error(
          place,
          "a segment has fewer than two points, or refers to a point that is not in the edges",
          "use the edges that the segments were made from");
    }
  }
  if (o.min_points < 3 || !(o.min_share >= 0) || !(o.max_off_sigma > 0) || !(o.reach_px >= 0) ||
      !(o.end_sigma_px > 0) || !(o.unstated_sigma_px > 0) || !(o.floor_px >= 0) ||
      !(o.floor_length_px > 0) || !(o.scale_px > 0) || !(o.moved_alike >= 0)) {
    throw Error(place, "an option is out of range",
                "use at least 3 points, and deviations and lengths above 0");
  }
}

}  // namespace

std::string_view describe(SegmentStatus status) {
  switch (status) {
    case SegmentStatus::placed:
      return "placed";
    case SegmentStatus::along_row:
      return "too close to horizontal: disparity not observable";
    case SegmentStatus::unmatched:
      return "too few of its points have a disparity";
    case SegmentStatus::disagree:
      return "the disparities of its points fit no common line";
    case SegmentStatus::behind:
      return "the disparity of an end is not above 0";
    case SegmentStatus::no_ray:
      return "the pixel of an end cannot be unprojected";
  }
  return "";
}

std::vector<SegmentDisparity> segment_disparities(const std::vector<EdgePoint>& edges,
                                                  const std::vector<EdgeSegment>& segments,
                                                  const std::vector<EdgeDisparity>& disparities,
                                                  const SegmentDisparityOptions& options) {
  check(edges, segments, disparities, options);
  std::vector<SegmentDisparity> all;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (SegmentDisparity& part : parts_of(edges, segments[i], disparities, options)) {
      part.segment = static_cast<int>(i);
      all.push_back(std::move(part));
    }
  }
  return all;
}

}  // namespace vernier::stereo::internal
