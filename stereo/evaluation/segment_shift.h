// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

namespace vernier::stereo::internal {

struct SegmentShiftOptions {
  double across_px = 4;      ///< right edges farther across are other ones
  double turned_rad = 0.44;  ///< and those turned by more (25°)
  int min_points = 8;        ///< of a segment, found in the right image
  double min_share = 0.7;    ///< of its points that are found
};

/// By how much a right edge is beside the place that the left one and the truth give it.
struct SegmentShift {
  Eigen::Vector2d left_px;            ///< the segment's middle
  Eigen::Vector2d normal;             ///< unit, in the right image, towards the brighter side
  double shift_px = 0;                ///< mean along the normal
  std::array<double, 2> halves_px{};  ///< means of its first and last part, 4 px apart
  double within_px = 0;               ///< standard deviation of its points about the mean
  int points = 0;
};

/// The lateral shift of every left segment between the two views, by its points away from steps of
/// the truth (docs/characterise.md). Points more than 1 px from the median are left out. The noise
/// of edge points is not common to both parts of a segment, a shift is:
///
///     E[h₁ h₂] = shift²,   h the means of the parts
std::vector<SegmentShift> segment_shifts(const std::vector<WarpedSegment>& left,
                                         const ImageEdges& right,
                                         const SegmentShiftOptions& options = {});

}  // namespace vernier::stereo::internal
