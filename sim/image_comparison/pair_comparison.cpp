// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/image_comparison/pair_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "calib/error.h"
#include "calib/statistics/quantile.h"
#include "sim/image_comparison/edge_sample.h"
#include "sim/image_comparison/explained_points.h"
#include "sim/images/rendered_pair.h"
#include "sim/images/true_edges.h"
#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/edges/image_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/rectified_images.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using Eigen::Vector2d;
using stereo::EdgeDisparity;
using stereo::GreyLevels;
using stereo::ImageSegment;
using stereo::Matcher;
using stereo::ValidPixels;
using stereo::internal::EdgeSegment;
using stereo::internal::ImageEdges;
using vernier::internal::median_or_zero;

namespace {

/// What one eye detects, put down to the lines that it sees.
struct EyeView {
  ImageEdges edges;
  ExplainedPoints explained;
  std::vector<int> segment_of_point;  ///< of at least the minimum length; -1: none
};

EyeView look_at(const GreyLevels& image,
                const std::vector<ImageSegment>& lines,
                const PairComparisonOptions& options) {
  EyeView view;
  view.edges = stereo::internal::image_edges(image);
  view.explained = explained_points(view.edges, lines, options.explain);
  view.segment_of_point = stereo::internal::segment_of_points(view.edges);
  for (int& segment : view.segment_of_point) {
    if (segment < 0) continue;
    const EdgeSegment& s = view.edges.segments[static_cast<std::size_t>(segment)];
    if (s.segment.length_px() < options.min_length_px) segment = -1;
  }
  return view;
}

/// Bilinear grey level; the border is replicated.
double grey_at(const GreyLevels& image, const Vector2d& at) {
  const double x = std::clamp(at.x(), 0.0, image.width_px - 1.001);
  const double y = std::clamp(at.y(), 0.0, image.height_px - 1.001);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double dx = x - i, dy = y - j;
  return (1 - dy) * ((1 - dx) * image(i, j) + dx * image(i + 1, j)) +
         dy * ((1 - dx) * image(i, j + 1) + dx * image(i + 1, j + 1));
}

bool has_source(const ValidPixels& valid, const Vector2d& at) {
  const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
  return x >= 0 && y >= 0 && x < valid.width_px && y < valid.height_px && valid(x, y);
}

/// Grey levels across an edge: the mean profile along its normal, in steps of half a pixel.
void measure_contrast(const GreyLevels& image,
                      const ImageSegment& edge,
                      double reach,
                      EdgeSample& sample) {
  const Vector2d normal = normal_of(edge);
  const int samples = std::clamp(static_cast<int>(edge.length_px() / 2), 5, 200);
  double low = 255, high = 0, first = 0, last = 0;
  for (double across = -reach; across <= reach; across += 0.5) {
    double sum = 0;
    for (int k = 0; k < samples; ++k) {
      const double t = (k + 0.5) / samples;
      sum += grey_at(image, edge.a_px + t * (edge.b_px - edge.a_px) + across * normal);
    }
    last = sum / samples;
    if (across == -reach) first = last;
    low = std::min(low, last);
    high = std::max(high, last);
  }
  sample.contrast = high - low;
  sample.brighter = last > first ? 1 : -1;
}

/// Marks the samples of an edge, one a pixel, that a point on a segment is near.
std::vector<char> covered(const EyeView& view, int line, const std::vector<double>& along) {
  constexpr double reach_px = 1;
  std::vector<double> points;
  for (const PointOnLine& p : view.explained.of_line[static_cast<std::size_t>(line)]) {
    if (view.segment_of_point[static_cast<std::size_t>(p.point)] >= 0) points.push_back(p.along_px);
  }
  std::vector<char> found;
  for (const double s : along) {
    const auto next = std::lower_bound(points.begin(), points.end(), s - reach_px);
    found.push_back(next != points.end() && *next <= s + reach_px ? 1 : 0);
  }
  return found;
}

double along_of(const ImageSegment& line, const Vector2d& at) {
  return (line.b_px - line.a_px).normalized().dot(at - line.a_px);
}

/// Distance from the middle of an edge to the nearest other line that runs along it there.
double neighbour_px(const TrueEdge& edge, const std::vector<ImageSegment>& lines) {
  constexpr double least_cosine = 0.985;  // 10°
  const Vector2d middle = (edge.left_px.a_px + edge.left_px.b_px) / 2;
  const Vector2d normal = normal_of(edge.left_px);
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (static_cast<int>(i) == edge.of_eye[0] || lines[i].length_px() == 0) continue;
    if (std::abs(normal.dot(normal_of(lines[i]))) < least_cosine) continue;
    const double along = along_of(lines[i], middle);
    if (along < 0 || along > lines[i].length_px()) continue;
    nearest = std::min(nearest, std::abs(normal_of(lines[i]).dot(middle - lines[i].a_px)));
  }
  return nearest;
}

/// Compares one true edge with what was found.
class EdgeComparison {
 public:
  EdgeComparison(const RenderedPair& pair,
                 const TrueEdges& truth,
                 const std::array<EyeView, 2>& eyes,
                 const PairComparisonOptions& options)
      : pair_(pair), truth_(truth), eyes_(eyes), options_(options) {}

  /// False if no part of the edge has a source in both images.
  bool compare(const TrueEdge& edge, EdgeSample& sample) const {
    sample.segment = edge.segment;
    sample.appearance = edge.appearance;
    sample.angle_rad = edge.angle_rad();
    sample.depth_m = edge.depth_m;
    sample.neighbour_px = neighbour_px(edge, truth_.of_eye[0]);
    measure_contrast(pair_.without_noise.left, edge.left_px, options_.contrast_reach_px, sample);
    if (!measure_loss(edge, sample)) return false;
    for (std::size_t eye = 0; eye < 2; ++eye) sample.shift_px[eye] = shift(edge, eye);
    for (std::size_t end = 0; end < 2; ++end) sample.ends[end] = end_error(edge, end, sample);
    return true;
  }

  MatchedEdge matched(const TrueEdge& edge, const std::vector<EdgeDisparity>& found) const {
    MatchedEdge result;
    if (edge.angle_rad() < options_.min_angle_rad) return result;
    std::vector<double> errors;
    int points = 0;
    for (const PointOnLine& p : points_of(edge, 0)) {
      ++points;
      const EdgeDisparity& match = found[static_cast<std::size_t>(p.point)];
      if (match.matched()) errors.push_back(match.disparity_px - disparity_at(edge, p));
    }
    result.asked = points >= options_.min_points;
    result.matched = result.asked && 2 * static_cast<int>(errors.size()) >= points;
    if (result.matched) result.error_px = median_or_zero(errors);
    return result;
  }

 private:
  const ImageSegment& line_of(const TrueEdge& edge, std::size_t eye) const {
    return truth_.of_eye[eye][static_cast<std::size_t>(edge.of_eye[eye])];
  }

  /// The points on an edge's line that lie between its ends.
  std::vector<PointOnLine> points_of(const TrueEdge& edge, std::size_t eye) const {
    const ImageSegment& line = line_of(edge, eye);
    const ImageSegment image = eye == 0 ? edge.left_px : edge.right_px();
    const double from = along_of(line, image.a_px), to = along_of(line, image.b_px);
    std::vector<PointOnLine> points;
    for (const PointOnLine& p :
         eyes_[eye].explained.of_line[static_cast<std::size_t>(edge.of_eye[eye])]) {
      if (p.along_px >= from && p.along_px <= to) points.push_back(p);
    }
    return points;
  }

  /// A straight edge in space has a disparity that is linear along its image.
  double disparity_at(const TrueEdge& edge, const PointOnLine& p) const {
    const double from = along_of(line_of(edge, 0), edge.left_px.a_px);
    const double t = std::clamp((p.along_px - from) / edge.left_px.length_px(), 0.0, 1.0);
    const double on_edge = edge.disparity_px[0] + t * (edge.disparity_px[1] - edge.disparity_px[0]);
    return on_edge;
  }

  bool measure_loss(const TrueEdge& edge, EdgeSample& sample) const {
    const int n = std::max(10, static_cast<int>(std::lround(edge.left_px.length_px())));
    const ImageSegment right = edge.right_px();
    std::array<std::vector<double>, 2> along;
    for (int k = 0; k < n; ++k) {
      const double t = (k + 0.5) / n;
      const Vector2d at = edge.left_px.a_px + t * (edge.left_px.b_px - edge.left_px.a_px);
      const Vector2d other = right.a_px + t * (right.b_px - right.a_px);
      if (!has_source(pair_.rectified.left_valid, at) ||
          !has_source(pair_.rectified.right_valid, other)) {
        continue;
      }
      along[0].push_back(along_of(line_of(edge, 0), at));
      along[1].push_back(along_of(line_of(edge, 1), other));
    }
    if (along[0].empty()) return false;
    const double px = edge.left_px.length_px() / n;
    const std::vector<char> left = covered(eyes_[0], edge.of_eye[0], along[0]);
    const std::vector<char> other = covered(eyes_[1], edge.of_eye[1], along[1]);
    double gap = 0;
    for (std::size_t k = 0; k < left.size(); ++k) {
      sample.length_px += px;
      sample.left_found_px += left[k] ? px : 0;
      sample.right_found_px += other[k] ? px : 0;
      if (left[k] && other[k]) {
        sample.both_found_px += px;
        gap = 0;
        continue;
      }
      if (gap == 0) ++sample.gaps;
      gap += px;
      sample.longest_gap_px = std::max(sample.longest_gap_px, gap);
    }
    return true;
  }

  double shift(const TrueEdge& edge, std::size_t eye) const {
    std::vector<double> across;
    for (const PointOnLine& p : points_of(edge, eye)) across.push_back(p.across_px);
    if (static_cast<int>(across.size()) < options_.min_points) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    return vernier::internal::quantile(std::move(across), 0.5,
                                       vernier::internal::QuantileKind::linear);
  }

  /// The end of the left image's segments on the edge that is nearest to an end of the edge.
  EndError end_error(const TrueEdge& edge, std::size_t end, const EdgeSample& sample) const {
    EndError result;
    result.kind = edge.ends[end];
    const ImageSegment& line = line_of(edge, 0);
    const double at = along_of(line, end == 0 ? edge.left_px.a_px : edge.left_px.b_px);
    const double outwards = end == 0 ? -1 : 1;
    double nearest = options_.end_px;
    for (const int number : segments_on(edge)) {
      const EdgeSegment& s = eyes_[0].edges.segments[static_cast<std::size_t>(number)];
      for (const Vector2d* x : {&s.segment.a_px, &s.segment.b_px}) {
        const double along = along_of(line, *x) - at;
        if (std::abs(along) > nearest) continue;
        nearest = std::abs(along);
        result.found = true;
        result.along_px = outwards * along;
        result.across_px = normal_of(line).dot(*x - line.a_px) - sample.shift_px[0];
      }
    }
    if (std::isnan(result.across_px)) result.found = false;
    return result;
  }

  /// Left segments of which most points are on the edge.
  std::vector<int> segments_on(const TrueEdge& edge) const {
    std::vector<int> segments;
    for (const PointOnLine& p :
         eyes_[0].explained.of_line[static_cast<std::size_t>(edge.of_eye[0])]) {
      const int s = eyes_[0].segment_of_point[static_cast<std::size_t>(p.point)];
      if (s >= 0) segments.push_back(s);
    }
    std::sort(segments.begin(), segments.end());
    std::vector<int> mostly;
    for (std::size_t k = 0; k < segments.size();) {
      std::size_t next = k;
      while (next < segments.size() && segments[next] == segments[k]) ++next;
      const EdgeSegment& s = eyes_[0].edges.segments[static_cast<std::size_t>(segments[k])];
      if (2 * (next - k) >= s.points.size()) mostly.push_back(segments[k]);
      k = next;
    }
    return mostly;
  }

  const RenderedPair& pair_;
  const TrueEdges& truth_;
  const std::array<EyeView, 2>& eyes_;
  const PairComparisonOptions& options_;
};

/// Lengths of the left segments of which less than half of the points are explained.
void add_false_segments(const EyeView& eye,
                        const ValidPixels& valid,
                        double min_length_px,
                        ComparedEdges& compared) {
  std::vector<double> lengths;
  double detected = 0;
  for (const EdgeSegment& s : eye.edges.segments) {
    const double length = s.segment.length_px();
    if (length < min_length_px || !has_source(valid, (s.segment.a_px + s.segment.b_px) / 2))
      continue;
    detected += length;
    std::size_t explained = 0;
    for (const int p : s.points)
      explained += eye.explained.explained[static_cast<std::size_t>(p)] ? 1 : 0;
    if (2 * explained < s.points.size()) lengths.push_back(length);
  }
  compared.false_px.push_back(std::move(lengths));
  compared.detected_px.push_back(detected);
}

}  // namespace

void add_pair(const RenderedPair& pair,
              const TrueEdges& truth,
              const stereo::DisparityRange& range,
              const std::vector<Matcher>& matchers,
              ComparedEdges& compared,
              const PairComparisonOptions& options) {
  const stereo::RectifiedPair& images = pair.rectified.pair;
  const std::array<EyeView, 2> eyes{look_at(images.left, truth.of_eye[0], options),
                                    look_at(images.right, truth.of_eye[1], options)};
  compared.matchers.clear();
  std::vector<std::vector<EdgeDisparity>> found;
  for (const Matcher& matcher : matchers) {
    compared.matchers.push_back(matcher.name);
    found.push_back(matcher.match(images, eyes[0].edges.points, range));
  }
  const EdgeComparison comparison(pair, truth, eyes, options);
  for (const TrueEdge& edge : truth.both) {
    EdgeSample sample;
    sample.pair = compared.pairs();
    if (!comparison.compare(edge, sample)) continue;
    for (const auto& disparities : found)
      sample.matches.push_back(comparison.matched(edge, disparities));
    compared.edges.push_back(std::move(sample));
  }
  add_false_segments(eyes[0], pair.rectified.left_valid, options.min_length_px, compared);
}

}  // namespace vernier::sim::internal
