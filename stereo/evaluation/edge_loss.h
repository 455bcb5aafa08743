// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

namespace vernier::stereo::internal {

struct EdgeLossOptions {
  double across_px = 2;      ///< maximum distance across of the corresponding right edge …
  double turned_rad = 0.44;  ///< … and maximum angle between the normals (25°)
};

/// How much of a left segment is detected in the right image.
struct SegmentLoss {
  Eigen::Vector2d left_px;   ///< midpoint
  double shown_px = 0;       ///< length visible in the right image
  double found_px = 0;       ///< part of it on a right edge
  double on_segment_px = 0;  ///< part of it on an edge that belongs to a right segment
  double chance_px = 0;      ///< part of it on a right segment when displaced: chance level
  int gaps = 0;              ///< number of stretches on no right segment
  double longest_gap_px = 0;
};

/// Detected length of every left segment among the right image's edges (docs/characterise.md). A
/// point is found if a right edge point of the same sign and direction lies within `across_px`
/// along the segment's normal and half the point spacing along it, at the foreground's disparity
/// or, at a truth discontinuity, at the background's. `chance_px` is the mean over displacements by
/// ±8 and ±12 px along the normal: what other edges would cover if this one were lost.
std::vector<SegmentLoss> edge_losses(const std::vector<WarpedSegment>& left,
                                     const ImageEdges& right,
                                     const EdgeLossOptions& options = {});

}  // namespace vernier::stereo::internal
