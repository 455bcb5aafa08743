// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

namespace vernier::stereo::internal {

struct EndDifferenceOptions {
  double across_px = 3;      ///< right segments farther across are other ones
  double turned_rad = 0.44;  ///< and those turned by more (25°)
  double min_share = 0.5;    ///< of the left segment's points that one right segment has to hold
};

/// An end of a right segment less where the left one's end should be.
struct EndDifference {
  double across_px = 0, along_px = 0;  ///< towards the brighter side; from a to b
  bool corner = false;                 ///< ends at a corner in both images
};

/// Both ends of a segment that is found in both images.
struct SegmentEnds {
  Eigen::Vector2d left_px;  ///< the segment's middle
  Eigen::Vector2d normal;   ///< unit, in the right image, towards the brighter side
  double length_px = 0;     ///< in the left image
  EndDifference a, b;
};

/// The ends of left segments, moved by the truth, against those of the right segments that hold
/// most of their points. What both ends have in common is a shift; half of the variance of the
/// difference between the ends is what two views' end points err by,
///
///     var(e_b − e_a) = 2 (σ_left² + σ_right²) = 4 σ²
///
/// A segment that is cut short in one image shows as a large difference along it.
std::vector<SegmentEnds> segment_ends(const ImageEdges& left,
                                      const std::vector<WarpedSegment>& warped,
                                      const ImageEdges& right,
                                      const EndDifferenceOptions& options = {});

}  // namespace vernier::stereo::internal
