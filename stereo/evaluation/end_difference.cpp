// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/end_difference.h"

#include <cmath>
#include <cstddef>
#include <map>

#include "stereo/edges/edge_neighbours.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

namespace vernier::stereo::internal {
namespace {

/// The right segment with the most points of a left segment; −1: none has enough.
int partner_of(const WarpedSegment& left,
               const EdgeNeighbours& neighbours,
               const std::vector<int>& segment_of,
               const EndDifferenceOptions& options) {
  const EdgeGate gate{options.across_px, 1, options.turned_rad};
  std::map<int, int> held;
  for (const WarpedPoint& point : left.points) {
    const EdgeNeighbour near = neighbours.nearest({point.right_px, left.normal}, gate);
    if (near.point < 0) continue;
    const int segment = segment_of[static_cast<std::size_t>(near.point)];
    if (segment >= 0) ++held[segment];
  }
  int partner = -1, most = 0;
  for (const auto& [segment, count] : held) {
    if (count > most) partner = segment, most = count;
  }
  return most < options.min_share * static_cast<double>(left.points.size()) ? -1 : partner;
}

}  // namespace

std::vector<SegmentEnds> segment_ends(const ImageEdges& left,
                                      const std::vector<WarpedSegment>& warped,
                                      const ImageEdges& right,
                                      const EndDifferenceOptions& options) {
  const EdgeNeighbours neighbours(right.points);
  const std::vector<int> segment_of = segment_of_points(right);
  std::vector<SegmentEnds> all;
  for (const WarpedSegment& segment : warped) {
    if (!segment.ends) continue;
    const int partner = partner_of(segment, neighbours, segment_of, options);
    if (partner < 0) continue;
    const EdgeSegment& own = left.segments[static_cast<std::size_t>(segment.segment)];
    const EdgeSegment& other = right.segments[static_cast<std::size_t>(partner)];
    const auto difference = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
      return EndDifference{segment.normal.dot(to - from), segment.direction.dot(to - from)};
    };
    SegmentEnds ends;
    ends.left_px = segment.left_px;
    ends.normal = segment.normal;
    ends.length_px = own.segment.length_px();
    ends.a = difference(segment.ends->a_px, other.segment.a_px);
    ends.b = difference(segment.ends->b_px, other.segment.b_px);
    ends.a.corner = own.a_is_corner && other.a_is_corner;
    ends.b.corner = own.b_is_corner && other.b_is_corner;
    all.push_back(ends);
  }
  return all;
}

}  // namespace vernier::stereo::internal
