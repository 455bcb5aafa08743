// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {

/// A straight edge's place to look at, and its way.
struct EdgePlace {
  Eigen::Vector2d at_px, normal;  ///< the normal is unit, towards the brighter side
};

/// How far an edge point may be from a place to be the same edge.
struct EdgeGate {
  double across_px = 2, along_px = 1;
  double turned_rad = 0.44;  ///< 25°, of the normals
};

/// An edge point beside a place.
struct EdgeNeighbour {
  int point = -1;        ///< −1: none
  double across_px = 0;  ///< from the place towards the brighter side
};

/// Finds edge points by their place. Keeps a reference to the points, sorted by (y, x).
class EdgeNeighbours {
 public:
  explicit EdgeNeighbours(const std::vector<EdgePoint>& points);

  /// The one in the gate that is nearest across. How far its edge is off is the mean of those of
  /// its string in the gate and within 1 px of it: the nearest one's own distance is too small, for
  /// it was chosen by its noise.
  EdgeNeighbour nearest(const EdgePlace& place, const EdgeGate& gate) const;

 private:
  double edge_across(const std::vector<EdgeNeighbour>& in_gate, const EdgeNeighbour& best) const;

  const std::vector<EdgePoint>& points_;
  std::vector<int> row_begin_;
};

}  // namespace vernier::stereo::internal
