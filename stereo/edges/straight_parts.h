// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"

namespace vernier::stereo::internal {

/// A part of a chain of points, [begin, end).
struct ChainPart {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
};

/// The straight parts of a chain of edge points, in its order. From the first point on each grows
/// while the rms of its orthogonal regression is below the threshold, its normals within 45° of
/// their mean; then the next begins. As growing runs past a corner, the break between two parts is
/// then moved to where the squares of both together are least, and points at the ends that are off
/// the line of the inner ones, in the rounding of a corner, are left out.
std::vector<ChainPart> straight_parts(const std::vector<EdgePoint>& points,
                                      std::span<const int> chain,
                                      const EdgeSegmentOptions& options);

}  // namespace vernier::stereo::internal
