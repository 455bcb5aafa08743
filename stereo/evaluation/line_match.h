// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/edges/image_edges.h"
#include "stereo/matcher.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {

struct LineMatchOptions {
  double min_angle_rad = 0.0873;  ///< segments closer to horizontal (5°) are skipped
  double min_share = 0.5;         ///< minimum fraction of a segment's points that must be matched
};

/// Match of a left segment as a whole.
struct LineMatch {
  Eigen::Vector2d left_px;  ///< midpoint
  double disparity_px = 0;  ///< ground truth, median of its points
  bool matched = false;     ///< at least `min_share` of its points are matched
  double error_px = 0;      ///< median of |found − true disparity| of its matched points
  bool occluded = false;    ///< most of its points are not visible in the right image
};

/// One per left segment with known ground truth at `min_share` of its points or more. At a truth
/// discontinuity the error is to the nearest surface (DiscontinuityRule::either). `found` has one
/// entry per edge point.
std::vector<LineMatch> line_matches(const ImageEdges& left,
                                    const std::vector<EdgeDisparity>& found,
                                    const StereoTruth& truth,
                                    const LineMatchOptions& options = {});

}  // namespace vernier::stereo::internal
