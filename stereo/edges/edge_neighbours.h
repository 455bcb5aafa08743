// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {

/// A query position on a straight edge.
struct EdgePlace {
  Eigen::Vector2d at_px, normal;  ///< unit normal, towards the brighter side
};

/// Maximum distance and rotation of an edge point that belongs to the same edge.
struct EdgeGate {
  double across_px = 2, along_px = 1;
  double turned_rad = 0.44;  ///< 25°, between the normals
};

/// An edge point near a query position.
struct EdgeNeighbour {
  int point = -1;        ///< −1: none
  double across_px = 0;  ///< from the query position towards the brighter side
};

/// Finds edge points by position. Keeps a reference to the points, sorted by (y, x).
class EdgeNeighbours {
 public:
  explicit EdgeNeighbours(const std::vector<EdgePoint>& points);

  /// The point within the gate that is nearest across the edge. The distance across is the mean
  /// over the points of its connected edge within the gate and within 1 px of it: the nearest
  /// point's own distance is biased towards 0, because it was selected by its noise.
  EdgeNeighbour nearest(const EdgePlace& place, const EdgeGate& gate) const;

 private:
  double edge_across(const std::vector<EdgeNeighbour>& in_gate, const EdgeNeighbour& best) const;

  const std::vector<EdgePoint>& points_;
  std::vector<int> row_begin_;
};

}  // namespace vernier::stereo::internal
