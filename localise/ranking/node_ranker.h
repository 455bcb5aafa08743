// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Score of a map node for a query.
struct RankedNode {
  int node = 0;
  double score = 0;      ///< in [0, 1]
  Pose2D query_in_node;  ///< roughly, as far as the ranker finds it
};

/// Orders the nodes of a map by their likeness to a view.
class NodeRanker {
 public:
  virtual ~NodeRanker() = default;
  /// The `most` nodes that are most alike, best first; ties keep the map's order.
  virtual std::vector<RankedNode> rank(const PlaceView& query, int most) const = 0;
  /// The score, for a view of the map's own, below which a node is not taken for its place.
  virtual double least_rival_score() const { return 0; }
  /// Scores that differ by less do not tell places apart.
  virtual double alike_within() const { return 0; }
};

/// `view` (ViewRanker), `pgh` or `pgh_aggregate` (HistogramRanker). The map must outlive it. Throws
/// Error for another name.
std::unique_ptr<NodeRanker> make_ranker(std::string_view name,
                                        const TopologicalMap& map,
                                        const PghOptions& histograms);

/// The first `most`, by descending score.
std::vector<RankedNode> best_of(std::vector<RankedNode> nodes, int most);

}  // namespace vernier::localise::internal
