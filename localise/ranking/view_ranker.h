// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "localise/ranking/view_descriptor.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Compares view descriptors at turns up to 20 degrees to either side.
class ViewRanker : public NodeRanker {
 public:
  explicit ViewRanker(const TopologicalMap& map);

  std::vector<RankedNode> rank(const PlaceView& query, int most) const override;

 private:
  DescriptorBins bins_;
  std::vector<std::uint16_t> nodes_;  // one shortened descriptor after the other
  std::size_t count_ = 0;
};

}  // namespace vernier::localise::internal
