// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/rank.h"

#include <algorithm>
#include <cstddef>

#include "localise/bhattacharyya.h"
#include "localise/localiser.h"
#include "localise/pgh.h"

namespace vernier::localise::internal {

std::vector<RankedNode> rank_nodes(const TopologicalMap& map, const Pgh& query) {
  std::vector<RankedNode> ranked;
  ranked.reserve(map.nodes.size());
  const auto mean = [](const Eigen::VectorXf& best, const Eigen::VectorXf& weights) {
    const float total = weights.sum();
    return total > 0 ? best.dot(weights) / total : 0.0f;
  };
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    const Pgh& node = map.histograms[i];
    double score = 0;
    if (node.rows.rows() > 0 && query.rows.rows() > 0) {
      const BestMatches best = best_matches(query.rows, node.rows);
      score = 0.5 * (mean(best.of_queries, query.weights) + mean(best.of_stored, node.weights));
    }
    ranked.push_back({static_cast<int>(i), score});
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const RankedNode& a, const RankedNode& b) { return a.score > b.score; });
  return ranked;
}

}  // namespace vernier::localise::internal
