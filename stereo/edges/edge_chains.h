// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {

/// Edge points in order along an edge, as indices into the list of points.
struct EdgeChain {
  std::vector<int> points;
  bool closed = false;  ///< the last point is a neighbour of the first
};

/// Orders edge points (sorted by (y, x), one per pixel) into chains. Neighbours are points in
/// 4-neighbouring pixels, and in diagonal pixels that share no 4-neighbouring point, with normals
/// less than 90° apart. A point with three or more neighbours is a junction: chains end there and
/// do not include it. Spurs of one or two points are dropped.
std::vector<EdgeChain> edge_chains(const std::vector<EdgePoint>& points);

}  // namespace vernier::stereo::internal
