// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

namespace vernier::stereo::internal {

struct EdgeLossOptions {
  double across_px = 2;      ///< a right edge this near across is the same one …
  double turned_rad = 0.44;  ///< … if its normal is turned by no more (25°)
};

/// How much of a left segment the right image has an edge for.
struct SegmentLoss {
  Eigen::Vector2d left_px;   ///< its middle
  double shown_px = 0;       ///< length that the right image should show
  double found_px = 0;       ///< of it, on a right edge
  double on_segment_px = 0;  ///< of it, on an edge that is part of a right segment
  double chance_px = 0;      ///< of it, on a right segment where the segment is displaced
  int gaps = 0;              ///< stretches that are on no right segment
  double longest_gap_px = 0;
};

/// Every left segment's length against the right image's edges (docs/characterise.md). A point is
/// found where a right edge point is within `across_px` along the segment's normal and half of the
/// points' spacing along it, of the same sign and direction, at the foreground's disparity or, at a
/// step of the truth, at the background's. `chance_px` is the mean over displacements by ±8 and ±12
/// px along the normal: what other edges would cover were this one lost.
std::vector<SegmentLoss> edge_losses(const std::vector<WarpedSegment>& left,
                                     const ImageEdges& right,
                                     const EdgeLossOptions& options = {});

}  // namespace vernier::stereo::internal
