// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {

/// Edge points in the order in which an edge passes through them, by their places in the list.
struct EdgeChain {
  std::vector<int> points;
  bool closed = false;  ///< the last is a neighbour of the first
};

/// The points of edges (sorted by (y, x), one a pixel), in order. Neighbours are points in
/// 4-neighbouring pixels, and in diagonal ones where no 4-neighbour of both is a point, whose
/// normals are less than 90° apart. A point of three and more neighbours is a junction, where
/// chains end and which is in none of them; a spur of one or two points is none.
std::vector<EdgeChain> edge_chains(const std::vector<EdgePoint>& points);

}  // namespace vernier::stereo::internal
