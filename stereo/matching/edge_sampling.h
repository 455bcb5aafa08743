// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/matcher.h"

namespace vernier::stereo::internal {

/// What a dense map says at an edge between two surfaces.
enum class EdgeSampling {
  nearest,     ///< that of the pixel where the edge crosses its row
  foreground,  ///< the largest of the 3 x 3 pixels about it: an outline belongs to what is nearer
};

/// Disparities of a dense map at edge points of the left image: interpolated along the row at
/// EdgePoint::row_x_px; where the 3 x 3 pixels about it hold a step (stereo_truth.h) as `sampling`
/// says. No match where the map does not know the nearest pixel. Confidence is 1. Throws Error for
/// edges outside the map.
std::vector<EdgeDisparity> sample_at_edges(const DisparityMap& map,
                                           const std::vector<EdgePoint>& edges,
                                           EdgeSampling sampling = EdgeSampling::foreground);

}  // namespace vernier::stereo::internal
