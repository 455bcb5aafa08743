// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/matcher.h"

namespace vernier::stereo::internal {

/// Which disparity of a dense map to use at an edge between two surfaces.
enum class EdgeSampling {
  nearest,     ///< that of the pixel where the edge crosses its row
  foreground,  ///< the largest of the 3 x 3 pixels around it that a second one has, within a pixel:
               ///< an occluding contour belongs to the nearer surface, and a pixel alone is none
};

/// Disparities of a dense map at edge points of the left image: interpolated along the row at
/// EdgePoint::row_x_px; if the 3 x 3 pixels around it contain a discontinuity (stereo_truth.h), by
/// `sampling`, with the nearest pixel's as `own_px`. No match if that is unknown. Confidence is 1.
/// Throws Error for edges outside the map.
std::vector<EdgeDisparity> sample_at_edges(const DisparityMap& map,
                                           const std::vector<EdgePoint>& edges,
                                           EdgeSampling sampling = EdgeSampling::foreground);

}  // namespace vernier::stereo::internal
