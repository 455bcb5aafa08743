// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sim/import/mesh.h"

namespace vernier::sim::internal {

struct CreaseOptions {
  double crease_rad = 0.35;       ///< surfaces that meet at a smaller angle make no edge
  double within_m = 1e-3;         ///< vertices so near to an edge lie on it
  double straight_rad = 0.005;    ///< pieces that continue each other so straight are one edge
  double rounding_m = 0;          ///< of vertices, by which short pieces may turn more
  double most_rounded_rad = 0.1;  ///< but not by so much, as at round things
};

/// What is found beside edges.
struct CreaseRemarks {
  /// Upright pieces of edges, of 1 m at least, where faces meet at less than 35 degrees: columns
  /// and bows of few flat faces.
  std::size_t shallow_uprights = 0;
};

/// The edges of a welded mesh that one would see: where it ends, where two of its planes meet at an
/// angle, and its own lines. Where the vertices of neighbours do not match (T-junctions), edges are
/// cut at all vertices that lie on them first, so that a plane made of unmatched triangles has no
/// edges inside. Pieces that continue each other in a straight line are joined.
std::vector<Segment> crease_edges(const Mesh& mesh,
                                  const CreaseOptions& options = {},
                                  CreaseRemarks* remarks = nullptr);

}  // namespace vernier::sim::internal
