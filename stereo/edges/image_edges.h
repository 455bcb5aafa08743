// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/grey_levels.h"

namespace vernier::stereo::internal {

/// Edge points and straight segments of an image.
struct ImageEdges {
  int width_px = 0, height_px = 0;
  std::vector<EdgePoint> points;      ///< sorted by (y, x)
  std::vector<EdgeSegment> segments;  ///< refer to `points`
};

/// Detects both. Throws Error as canny_edges and edge_segments do.
ImageEdges image_edges(const GreyLevels& image,
                       const CannyOptions& canny = {},
                       const EdgeSegmentOptions& segments = {});

/// Index of the segment that each point belongs to; −1: none.
std::vector<int> segment_of_points(const ImageEdges& edges);

}  // namespace vernier::stereo::internal
