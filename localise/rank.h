// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/localiser.h"
#include "localise/pgh.h"

namespace vernier::localise::internal {

/// How well a node explains a query.
struct RankedNode {
  int node = 0;
  double score = 0;  ///< in [0, 1]
};

/// Nodes of the map, best first. A node's score is the mean of two averages: over the query's
/// lines, weighted, of each one's best Bhattacharyya coefficient among the node's lines; and over
/// the node's lines of theirs among the query's. Ties keep the map's order.
std::vector<RankedNode> rank_nodes(const TopologicalMap& map, const Pgh& query);

}  // namespace vernier::localise::internal
