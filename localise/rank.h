// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/localiser.h"
#include "localise/pgh.h"

namespace vernier::localise::internal {

/// Score of a map node for a query.
struct RankedNode {
  int node = 0;
  double score = 0;  ///< in [0, 1]
};

/// Map nodes, best first. A node's score is the mean of two averages: the weighted average over the
/// query's lines of the best Bhattacharyya coefficient among the node's lines, and that over the
/// node's lines among the query's. Ties keep the map's order.
std::vector<RankedNode> rank_nodes(const TopologicalMap& map, const Pgh& query);

}  // namespace vernier::localise::internal
