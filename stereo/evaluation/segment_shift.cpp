// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/segment_shift.h"

#include "calib/statistics/quantile.h"
#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "stereo/edges/edge_neighbours.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

constexpr double part_distance_px = 4;  // between the two parts: edge noise is correlated over 3 px
constexpr double outlier_px = 1;        // from the median
constexpr int min_in_part = 3;

struct Beside {
  double along_px, across_px;
};

double median_across(const std::vector<Beside>& points) {
  std::vector<double> across;
  across.reserve(points.size());
  for (const Beside& point : points) across.push_back(point.across_px);
  return median_or_zero(std::move(across));
}

double mean_across(const std::vector<Beside>& points, double from_px, double to_px, int& count) {
  double sum = 0;
  count = 0;
  for (const Beside& point : points) {
    if (point.along_px < from_px || point.along_px > to_px) continue;
    sum += point.across_px;
    ++count;
  }
  return sum / std::max(1, count);
}

/// The shift of points of one edge, if both parts have enough.
std::optional<SegmentShift> shift_of(const WarpedSegment& left, std::vector<Beside> points) {
  const double middle_px = median_across(points);
  std::erase_if(points, [&](const Beside& point) {
    return std::abs(point.across_px - middle_px) > outlier_px;
  });
  SegmentShift shift;
  shift.left_px = left.left_px;
  shift.normal = left.normal;
  const double begin = points.front().along_px, end = points.back().along_px;
  const double middle = 0.5 * (begin + end);
  int first = 0, last = 0;
  shift.halves_px[0] = mean_across(points, begin, middle - part_distance_px / 2, first);
  shift.halves_px[1] = mean_across(points, middle + part_distance_px / 2, end, last);
  if (first < min_in_part || last < min_in_part) return std::nullopt;
  shift.shift_px = mean_across(points, begin, end, shift.points);
  double squares = 0;
  for (const Beside& point : points) squares += std::pow(point.across_px - shift.shift_px, 2);
  shift.within_px = std::sqrt(squares / (shift.points - 1));
  return shift;
}

}  // namespace

std::vector<SegmentShift> segment_shifts(const std::vector<WarpedSegment>& left,
                                         const ImageEdges& right,
                                         const SegmentShiftOptions& options) {
  const EdgeNeighbours neighbours(right.points);
  const EdgeGate gate{options.across_px, 1, options.turned_rad};
  std::vector<SegmentShift> shifts;
  for (const WarpedSegment& segment : left) {
    std::vector<Beside> found;
    int asked = 0;
    for (const WarpedPoint& point : segment.points) {
      if (point.outline) continue;
      ++asked;
      const EdgeNeighbour near = neighbours.nearest({point.right_px, segment.normal}, gate);
      if (near.point >= 0) found.push_back({point.along_px, near.across_px});
    }
    const auto enough = std::max<double>(options.min_points, options.min_share * asked);
    if (static_cast<double>(found.size()) < enough) continue;
    std::sort(found.begin(), found.end(),
              [](const Beside& a, const Beside& b) { return a.along_px < b.along_px; });
    if (const auto shift = shift_of(segment, std::move(found))) shifts.push_back(*shift);
  }
  return shifts;
}

}  // namespace vernier::stereo::internal
