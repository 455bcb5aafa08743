// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"

namespace vernier::stereo {

/// A matcher's result at an edge point of the left image.
struct EdgeDisparity {
  float disparity_px = std::numeric_limits<float>::quiet_NaN();  ///< NaN: no match
  float sigma_px = std::numeric_limits<float>::quiet_NaN();  ///< standard deviation; NaN: not given
  float confidence = 0;  ///< larger is more certain; used for error–density curves
  /// Of a dense map whose disparity here is that of the foreground around the edge, the pixel's
  /// own; NaN: the same.
  float own_px = std::numeric_limits<float>::quiet_NaN();

  bool matched() const { return disparity_px == disparity_px; }
};

/// Signature of a stereo matcher: disparities of the pair at the left edge points, one per point.
/// Throws Error for images of different sizes or an empty range.
using MatchEdges = std::function<std::vector<EdgeDisparity>(
    const RectifiedPair& pair, const std::vector<EdgePoint>& left_edges, const DisparityRange&)>;

struct Matcher {
  std::string name;
  MatchEdges match;
  bool of_edges = false;  ///< sparse: works on edges, so edge detection counts towards its time
};

}  // namespace vernier::stereo
