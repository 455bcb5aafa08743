// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/edge_loss.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "stereo/canny_edges.h"
#include "stereo/edges/edge_neighbours.h"
#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

namespace vernier::stereo::internal {
namespace {

constexpr std::array<double, 4> displacements_px = {-12, -8, 8, 12};
constexpr double slack_px = 0.2;  // along: an edge point is expected every half spacing

class LossSearch {
 public:
  LossSearch(const ImageEdges& right, const EdgeLossOptions& options)
      : all_(right.points), gate_{options.across_px, 0, options.turned_rad} {
    const std::vector<int> segment = segment_of_points(right);
    for (std::size_t i = 0; i < segment.size(); ++i) {
      if (segment[i] >= 0) on_segments_.push_back(right.points[i]);
    }
    segments_.emplace(on_segments_);
  }

  SegmentLoss operator()(const WarpedSegment& left) const {
    SegmentLoss loss;
    loss.left_px = left.left_px;
    double gap_px = 0;
    for (const WarpedPoint& point : left.points) {
      const double length = left.spacing_px;
      loss.shown_px += length;
      if (found(all_, left, point, 0)) loss.found_px += length;
      for (const double displacement : displacements_px) {
        if (!found(*segments_, left, point, displacement)) continue;
        loss.chance_px += length / static_cast<double>(displacements_px.size());
      }
      if (found(*segments_, left, point, 0)) {
        loss.on_segment_px += length;
        gap_px = 0;
        continue;
      }
      loss.gaps += gap_px == 0;
      gap_px += length;
      loss.longest_gap_px = std::max(loss.longest_gap_px, gap_px);
    }
    return loss;
  }

 private:
  bool found(const EdgeNeighbours& edges,
             const WarpedSegment& left,
             const WarpedPoint& point,
             double displacement_px) const {
    EdgeGate gate = gate_;
    gate.along_px = 0.5 * left.spacing_px + slack_px;
    const auto is_at = [&](const Eigen::Vector2d& px) {
      const EdgePlace place{px + displacement_px * left.normal, left.normal};
      return edges.nearest(place, gate).point >= 0;
    };
    return is_at(point.right_px) || (point.other_px != point.right_px && is_at(point.other_px));
  }

  EdgeNeighbours all_;
  std::vector<EdgePoint> on_segments_;
  std::optional<EdgeNeighbours> segments_;
  EdgeGate gate_;
};

}  // namespace

std::vector<SegmentLoss> edge_losses(const std::vector<WarpedSegment>& left,
                                     const ImageEdges& right,
                                     const EdgeLossOptions& options) {
  const LossSearch search(right, options);
  std::vector<SegmentLoss> losses;
  losses.reserve(left.size());
  for (const WarpedSegment& segment : left) losses.push_back(search(segment));
  return losses;
}

}  // namespace vernier::stereo::internal
