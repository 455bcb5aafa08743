// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/view_ranker.h"

#include <cstddef>
#include <utility>

#include "localise/topological_map.h"

namespace vernier::localise::internal {

ViewRanker::ViewRanker(const TopologicalMap& map)
    : bins_(descriptor_bins(map)), count_(map.nodes.size()) {
  nodes_.reserve(count_ * static_cast<std::size_t>(bins_.size()));
  for (const MapNode& node : map.nodes) {
    const auto row = shortened_descriptor(view_descriptor(node.view.lines, bins_));
    nodes_.insert(nodes_.end(), row.begin(), row.end());
  }
}

std::vector<RankedNode> ViewRanker::rank(const PlaceView& query, int most) const {
  std::vector<TurnedProduct> products(count_);
  turned_products(view_descriptor(query.lines, bins_), nodes_, bins_, products);
  std::vector<RankedNode> ranked;
  ranked.reserve(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    ranked.push_back({static_cast<int>(i), products[i].product,
                      products[i].turn_bins * DescriptorBins::bearing_rad});
  }
  return best_of(std::move(ranked), most);
}

}  // namespace vernier::localise::internal
