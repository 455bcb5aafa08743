// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/warped_segments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calib/error.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_line.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/edges/image_edges.h"
#include "stereo/segment.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {
namespace {

constexpr double beyond_px = 3, beyond_corner_px = 9;  // of ends from the last visible points

/// A straight line fitted to (s, d).
struct TruthLine {
  double at_zero = 0, slope = 0, rms = 0;
  double operator()(double s) const { return at_zero + slope * s; }
};

std::optional<TruthLine> line_through(const std::vector<Eigen::Vector2d>& values) {
  if (values.size() < 4) return std::nullopt;
  const auto n = static_cast<double>(values.size());
  Eigen::Vector2d mean(0, 0);
  for (const Eigen::Vector2d& v : values) mean += v / n;
  double ss = 0, sd = 0, dd = 0;
  for (const Eigen::Vector2d& v : values) {
    const Eigen::Vector2d e = v - mean;
    ss += e.x() * e.x();
    sd += e.x() * e.y();
    dd += e.y() * e.y();
  }
  if (!(ss > 0)) return std::nullopt;
  TruthLine line;
  line.slope = sd / ss;
  line.at_zero = mean.y() - line.slope * mean.x();
  line.rms = std::sqrt(std::max(0.0, dd - line.slope * sd) / (n - 2));
  return line;
}

Eigen::Vector2d moved(const Eigen::Vector2d& left_px, double disparity_px) {
  return {left_px.x() - disparity_px, left_px.y()};
}

class SegmentWarp {
 public:
  SegmentWarp(const ImageEdges& left, const StereoTruth& truth, const WarpOptions& options)
      : left_(left), options_(options), truth_(truth_at(truth, left.points)) {}

  std::optional<WarpedSegment> operator()(int index) const {
    const EdgeSegment& from = left_.segments[static_cast<std::size_t>(index)];
    if (from.segment.length_px() < options_.min_length_px) return std::nullopt;
    WarpedSegment to;
    to.segment = index;
    to.left_px = 0.5 * (from.segment.a_px + from.segment.b_px);
    const Eigen::Vector2d along = (from.segment.b_px - from.segment.a_px).normalized();
    std::vector<Eigen::Vector2d> disparities;
    double first = 0, last = 0;  // along, of all its points
    Eigen::Vector2d brighter(0, 0);
    for (const int point : from.points) {
      const EdgePoint& edge = left_.points[static_cast<std::size_t>(point)];
      const double s = along.dot(edge.pixel_px.cast<double>() - from.segment.a_px);
      first = point == from.points.front() ? s : std::min(first, s);
      last = point == from.points.front() ? s : std::max(last, s);
      brighter += edge.normal.cast<double>();
      add_point(edge, truth_[static_cast<std::size_t>(point)], s, to, disparities);
    }
    if (to.points.size() < static_cast<std::size_t>(options_.min_points)) return std::nullopt;
    to.spacing_px = (last - first) / static_cast<double>(from.points.size() - 1);
    set_direction(brighter, to);
    to.ends = ends_of(from, to, disparities);
    return to;
  }

 private:
  void add_point(const EdgePoint& edge,
                 const TruthAtEdge& at,
                 double s,
                 WarpedSegment& to,
                 std::vector<Eigen::Vector2d>& disparities) const {
    if (!at.known || at.occluded) return;
    const Eigen::Vector2d p = edge.pixel_px.cast<double>();
    WarpedPoint point;
    point.right_px = moved(p, at.disparity_px);
    const bool step = at.discontinuity && at.max_px - at.min_px > 1;
    point.other_px = step ? moved(p, at.min_px) : point.right_px;
    point.along_px = s;
    point.outline = at.discontinuity;
    const double x = point.right_px.x();
    if (x < options_.border_px || x > left_.width_px - 1 - options_.border_px) return;
    to.points.push_back(point);
    if (!at.discontinuity) disparities.emplace_back(s, at.disparity_px);
  }

  static void set_direction(const Eigen::Vector2d& brighter, WarpedSegment& to) {
    LineRegression line;
    for (const WarpedPoint& point : to.points) line.add(point.right_px);
    to.direction = line.direction();
    if (to.direction.dot(to.points.back().right_px - to.points.front().right_px) < 0) {
      to.direction = -to.direction;
    }
    to.normal = {-to.direction.y(), to.direction.x()};
    if (to.normal.dot(brighter) < 0) to.normal = -to.normal;
  }

  std::optional<ImageSegment> ends_of(const EdgeSegment& from,
                                      const WarpedSegment& to,
                                      const std::vector<Eigen::Vector2d>& disparities) const {
    const auto line = line_through(disparities);
    if (!line || line->rms > options_.max_rms_px) return std::nullopt;
    const double length = from.segment.length_px();
    const double before = to.points.front().along_px, after = length - to.points.back().along_px;
    if (before > (from.a_is_corner ? beyond_corner_px : beyond_px) ||
        after > (from.b_is_corner ? beyond_corner_px : beyond_px)) {
      return std::nullopt;
    }
    return ImageSegment{moved(from.segment.a_px, (*line)(0)),
                        moved(from.segment.b_px, (*line)(length))};
  }

  const ImageEdges& left_;
  WarpOptions options_;
  std::vector<TruthAtEdge> truth_;
};

}  // namespace

std::vector<WarpedSegment> warped_segments(const ImageEdges& left,
                                           const StereoTruth& truth,
                                           const WarpOptions& options) {
  if (truth.disparity.width_px != left.width_px || truth.disparity.height_px != left.height_px) {
    throw Error("warped segments", "the ground truth differs in size from the left image",
                "use the ground truth of this image");
  }
  const SegmentWarp warp(left, truth, options);
  std::vector<WarpedSegment> warped;
  for (std::size_t s = 0; s < left.segments.size(); ++s) {
    if (auto segment = warp(static_cast<int>(s))) warped.push_back(std::move(*segment));
  }
  return warped;
}

}  // namespace vernier::stereo::internal
