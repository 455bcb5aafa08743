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

/// What a matcher says at a point of the left image.
struct EdgeDisparity {
  float disparity_px = std::numeric_limits<float>::quiet_NaN();  ///< not a number: no match
  float sigma_px = std::numeric_limits<float>::quiet_NaN();      ///< not a number: not stated
  float confidence = 0;  ///< larger is surer, for curves of error against density

  bool matched() const { return disparity_px == disparity_px; }
};

/// A stereo matcher: disparities of the pair at the left edge points, one for each. Throws Error on
/// images of unequal size or an empty range.
using MatchEdges = std::function<std::vector<EdgeDisparity>(
    const RectifiedPair& pair, const std::vector<EdgePoint>& left_edges, const DisparityRange&)>;

struct Matcher {
  std::string name;
  MatchEdges match;
  bool of_edges = false;  ///< works on edges, so that finding them is part of its time
};

}  // namespace vernier::stereo
