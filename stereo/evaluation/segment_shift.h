// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

namespace vernier::stereo::internal {

struct SegmentShiftOptions {
  double across_px = 4;      ///< maximum distance across of the corresponding right edge
  double turned_rad = 0.44;  ///< maximum angle between the normals (25°)
  int min_points = 8;        ///< minimum number of a segment's points found in the right image
  double min_share = 0.7;    ///< minimum fraction of its points that are found
};

/// Offset of a right edge from the position predicted by the left edge and the ground truth.
struct SegmentShift {
  Eigen::Vector2d left_px;            ///< midpoint of the segment
  Eigen::Vector2d normal;             ///< unit, in the right image, towards the brighter side
  double shift_px = 0;                ///< mean along the normal
  std::array<double, 2> halves_px{};  ///< means of its first and last part, 4 px apart
  double within_px = 0;               ///< standard deviation of its points about the mean
  int points = 0;
};

/// Lateral shift of every left segment between the two views, from its points away from truth
/// discontinuities (docs/characterise.md). Points more than 1 px from the median are dropped. Edge
/// noise is independent in the two parts of a segment and a shift is common to both, so
///     E[h₁ h₂] = shift²,   h the means of the parts
std::vector<SegmentShift> segment_shifts(const std::vector<WarpedSegment>& left,
                                         const ImageEdges& right,
                                         const SegmentShiftOptions& options = {});

}  // namespace vernier::stereo::internal
