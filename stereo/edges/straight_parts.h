// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"

namespace vernier::stereo::internal {

/// A range [begin, end) of a chain of points.
struct ChainPart {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
};

/// Splits a chain of edge points into straight parts, in order. A part grows from its first point
/// while the RMS distance from its orthogonal regression line is below the threshold and its
/// normals are within 45° of their mean; then the next begins. Since growing overshoots corners,
/// the break between two parts is then moved to minimise the sum of squares of both, and end points
/// off the line of the inner ones (rounded corners) are removed.
std::vector<ChainPart> straight_parts(const std::vector<EdgePoint>& points,
                                      std::span<const int> chain,
                                      const EdgeSegmentOptions& options);

}  // namespace vernier::stereo::internal
