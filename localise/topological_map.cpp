// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/localiser.h"

#include <utility>

#include "localise/pgh.h"

namespace vernier::localise {

TopologicalMap make_map(std::vector<MapNode> nodes, const PghOptions& options) {
  TopologicalMap map{std::move(nodes), options, {}};
  map.histograms.reserve(map.nodes.size());
  for (const MapNode& node : map.nodes) {
    map.histograms.push_back(spatial_histograms(node.view.lines, options));
  }
  return map;
}

}  // namespace vernier::localise
