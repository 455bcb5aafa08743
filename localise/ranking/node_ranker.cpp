// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/node_ranker.h"

#include <algorithm>
#include <cstddef>

#include "calib/base/shown_text.h"
#include "calib/error.h"
#include "localise/pgh.h"
#include "localise/ranking/histogram_ranker.h"
#include "localise/ranking/view_ranker.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

std::unique_ptr<NodeRanker> make_ranker(std::string_view name,
                                        const TopologicalMap& map,
                                        const PghOptions& histograms) {
  if (name == "view") return std::make_unique<ViewRanker>(map);
  if (name == "pgh") return std::make_unique<HistogramRanker>(map, histograms);
  if (name == "pgh_aggregate") return std::make_unique<AggregateRanker>(map, histograms);
  throw Error("ranker " + vernier::internal::in_quotes(name), "unknown ranker",
              "use view, pgh or pgh_aggregate");
}

std::vector<RankedNode> best_of(std::vector<RankedNode> nodes, int most) {
  const auto better = [](const RankedNode& a, const RankedNode& b) {
    return a.score != b.score ? a.score > b.score : a.node < b.node;
  };
  const auto kept = std::min<std::size_t>(std::max(most, 0), nodes.size());
  std::partial_sort(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(kept), nodes.end(),
                    better);
  nodes.resize(kept);
  return nodes;
}

}  // namespace vernier::localise::internal
