// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/map/node_grid.h"
#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "localise/ranking/panorama.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Compares a view's descriptor with panoramas at the map's positions and beside them, at all
/// headings that are known there.
class ViewRanker : public NodeRanker {
 public:
  explicit ViewRanker(const TopologicalMap& map);

  std::vector<RankedNode> rank(const PlaceView& query, int most) const override;

 private:
  const TopologicalMap& map_;
  NodeGrid grid_;
  int in_view_;
  std::vector<Panorama> panoramas_;
};

}  // namespace vernier::localise::internal
