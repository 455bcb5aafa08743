// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/edges/edge_segments.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "calib/error.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_chains.h"
#include "stereo/edges/edge_line.h"
#include "stereo/edges/straight_parts.h"

namespace vernier::stereo::internal {
namespace {

constexpr double end_sigma_px = 3;     // along the line, of an end that is not a corner
constexpr double corner_reach_px = 8;  // maximum distance of a segment's last point from the corner
constexpr double corner_sigma_px = 0.5;  // maximum standard deviation of a corner

/// Rotates a closed chain to begin where it turns most, so that no side is cut in two.
void start_at_a_corner(const std::vector<EdgePoint>& points, std::vector<int>& chain) {
  const std::size_t size = chain.size();
  constexpr std::size_t step = 3;
  std::size_t corner = 0;
  float least = 2;
  for (std::size_t i = 0; i < size; ++i) {
    const float cosine =
        points[chain[(i + size - step) % size]].normal.dot(points[chain[(i + step) % size]].normal);
    if (cosine < least) {
      least = cosine;
      corner = i;
    }
  }
  std::rotate(chain.begin(), chain.begin() + static_cast<long>(corner), chain.end());
}

struct End {
  Eigen::Vector2d place;
  Eigen::Matrix2d covariance;
  bool is_corner = false;
};

/// Intersection of two lines, if near both ends and accurate enough.
std::optional<End> corner_of(const EdgeLine& one,
                             const Eigen::Vector2d& one_end,
                             const EdgeLine& other,
                             const Eigen::Vector2d& other_end) {
  Eigen::Matrix2d normals;
  normals << one.normal.transpose(), other.normal.transpose();
  if (std::abs(normals.determinant()) < 0.02) return std::nullopt;
  const Eigen::Matrix2d inverse = normals.inverse();
  const Eigen::Vector2d place =
      one.centroid + inverse * Eigen::Vector2d(0, other.normal.dot(other.centroid - one.centroid));
  if ((place - one_end).norm() > corner_reach_px || (place - other_end).norm() > corner_reach_px) {
    return std::nullopt;
  }
  const Eigen::Vector2d variances(one.across_variance(one.along(place)),
                                  other.across_variance(other.along(place)));
  const Eigen::Matrix2d covariance = inverse * variances.asDiagonal() * inverse.transpose();
  if (covariance.trace() > corner_sigma_px * corner_sigma_px) return std::nullopt;
  return End{place, covariance, true};
}

/// Segments of one chain.
class ChainSegments {
 public:
  ChainSegments(const std::vector<EdgePoint>& points,
                EdgeChain chain,
                const EdgeSegmentOptions& options)
      : points_(points), chain_(std::move(chain)) {
    if (chain_.closed) start_at_a_corner(points, chain_.points);
    parts_ = straight_parts(points, chain_.points, options);
    for (const ChainPart& part : parts_) {
      const auto places = std::span(chain_.points).subspan(part.begin, part.size());
      lines_.emplace_back(points, places, options.scale_px);
      first_.push_back(plain_end(lines_.back(), places.front()));
      last_.push_back(plain_end(lines_.back(), places.back()));
    }
    for (std::size_t k = 0; k + 1 < parts_.size(); ++k) join(k, k + 1);
    if (chain_.closed && parts_.size() > 2) join(parts_.size() - 1, 0);
  }

  void append_to(std::vector<EdgeSegment>& segments) const {
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      EdgeSegment segment;
      const auto from = chain_.points.begin() + parts_[k].begin;
      segment.points.assign(from, from + parts_[k].size());
      End a = first_[k], b = last_[k];
      if (lines_[k].along(a.place) > lines_[k].along(b.place)) {
        std::swap(a, b);
        std::reverse(segment.points.begin(), segment.points.end());
      }
      segment.segment = {a.place, b.place};
      segment.a_covariance_px2 = a.covariance;
      segment.b_covariance_px2 = b.covariance;
      segment.a_is_corner = a.is_corner;
      segment.b_is_corner = b.is_corner;
      segment.rms_px = lines_[k].rms_px;
      segments.push_back(std::move(segment));
    }
  }

 private:
  /// An end that is not a corner.
  End plain_end(const EdgeLine& line, int point) const {
    const double along = line.along(points_[point].pixel_px.cast<double>());
    return {line.at(along),
            line.across_variance(along) * line.normal * line.normal.transpose() +
                end_sigma_px * end_sigma_px * line.direction * line.direction.transpose()};
  }

  void join(std::size_t k, std::size_t next) {
    const auto corner = corner_of(lines_[k], last_[k].place, lines_[next], first_[next].place);
    if (corner) last_[k] = first_[next] = *corner;
  }

  const std::vector<EdgePoint>& points_;
  EdgeChain chain_;
  std::vector<ChainPart> parts_;
  std::vector<EdgeLine> lines_;
  std::vector<End> first_, last_;
};

void check(const std::vector<EdgePoint>& points, const EdgeSegmentOptions& options) {
  const auto not_after = [](const EdgePoint& a, const EdgePoint& b) {
    return a.y > b.y || (a.y == b.y && a.x >= b.x);
  };
  if (std::adjacent_find(points.begin(), points.end(), not_after) != points.end()) {
    throw Error("edge_segments", "the points are not sorted by y, then x, with one per pixel",
                "use the order of canny_edges");
  }
  if (!points.empty() &&
      (points.front().y < 0 || std::any_of(points.begin(), points.end(),
                                           [](const EdgePoint& point) { return point.x < 0; }))) {
    throw Error("edge_segments", "a point has a negative pixel", "count pixels from 0");
  }
  if (!(options.max_rms_px > 0)) {
    throw Error("edge_segments", "max_rms_px is not above 0", "use e.g. 0.15 px");
  }
  if (options.min_points < 4) {
    throw Error("edge_segments", "a segment needs at least 4 points", "use e.g. 8");
  }
  if (!(options.scale_px > 0)) {
    throw Error("edge_segments", "the scale is not above 0 px", "use that of canny_edges");
  }
}

}  // namespace

std::vector<EdgeSegment> edge_segments(const std::vector<EdgePoint>& points,
                                       const EdgeSegmentOptions& options) {
  check(points, options);
  std::vector<EdgeSegment> segments;
  for (EdgeChain& chain : edge_chains(points)) {
    ChainSegments(points, std::move(chain), options).append_to(segments);
  }
  const auto first = [](const EdgeSegment& segment) {
    return std::min(segment.points.front(), segment.points.back());
  };
  std::stable_sort(segments.begin(), segments.end(),
                   [&](const EdgeSegment& a, const EdgeSegment& b) { return first(a) < first(b); });
  return segments;
}

}  // namespace vernier::stereo::internal
