// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/evaluation/warped_segments.h"

namespace vernier::stereo::internal {

struct EndDifferenceOptions {
  double across_px = 3;      ///< maximum distance across of the corresponding right segment
  double turned_rad = 0.44;  ///< maximum angle between the segments (25°)
  double min_share = 0.5;    ///< minimum fraction of the left segment's points on one right segment
};

/// End of a right segment minus the true position of the left segment's end.
struct EndDifference {
  double across_px = 0, along_px = 0;  ///< towards the brighter side; from a to b
  bool corner = false;                 ///< ends at a corner in both images
};

/// Both ends of a segment found in both images.
struct SegmentEnds {
  Eigen::Vector2d left_px;  ///< midpoint of the segment
  Eigen::Vector2d normal;   ///< unit, in the right image, towards the brighter side
  double length_px = 0;     ///< in the left image
  EndDifference a, b;
};

/// Compares the ends of left segments, moved by the ground truth, with those of the right segments
/// that contain most of their points. An error common to both ends is a shift; the variance of the
/// difference between the ends gives the end-point error of a view,
///
///     var(e_b − e_a) = 2 (σ_left² + σ_right²) = 4 σ²
///
/// A segment cut short in one image shows as a large difference along it.
std::vector<SegmentEnds> segment_ends(const ImageEdges& left,
                                      const std::vector<WarpedSegment>& warped,
                                      const ImageEdges& right,
                                      const EndDifferenceOptions& options = {});

}  // namespace vernier::stereo::internal
