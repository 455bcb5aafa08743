// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/matcher.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

struct LineMatchOptions {
  double min_angle_rad = 0.0873;  ///< segments nearer to the row (5°) are not asked
  double min_share = 0.5;         ///< of a segment's points that have to be matched
};

/// What a matcher made of a left segment as a whole.
struct LineMatch {
  Eigen::Vector2d left_px;  ///< its middle
  double disparity_px = 0;  ///< true, the median of its points
  bool matched = false;     ///< at least `min_share` of its points are
  double error_px = 0;      ///< median of |found − true disparity| of its matched points
  bool occluded = false;    ///< the right image does not show most of its points
};

/// Left segments of which the truth knows at least `min_share` of the points. An error at a step
/// of the truth is to the nearest surface (DiscontinuityRule::either). `found` holds one for each
/// point.
std::vector<LineMatch> line_matches(const ImageEdges& left,
                                    const std::vector<EdgeDisparity>& found,
                                    const StereoTruth& truth,
                                    const LineMatchOptions& options = {});

}  // namespace vernier::stereo::internal
