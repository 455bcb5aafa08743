// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Compares every line's histogram with every line's of every node. A node's score is the mean of
/// two averages: the weighted average over the query's lines of the best Bhattacharyya coefficient
/// among the node's lines, and that over the node's lines among the query's.
class HistogramRanker : public NodeRanker {
 public:
  HistogramRanker(const TopologicalMap& map, const PghOptions& options);

  std::vector<RankedNode> rank(const PlaceView& query, int most) const override;

 private:
  PghOptions options_;
  std::vector<Pgh> nodes_;
};

/// Compares one histogram a view: the weighted mean of its lines' histograms.
class AggregateRanker : public NodeRanker {
 public:
  AggregateRanker(const TopologicalMap& map, const PghOptions& options);

  std::vector<RankedNode> rank(const PlaceView& query, int most) const override;

 private:
  PghOptions options_;
  HistogramRows nodes_;
};

}  // namespace vernier::localise::internal
