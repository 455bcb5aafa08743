// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/histogram_ranker.h"

#include <cstddef>
#include <utility>

#include "localise/histograms/best_matches.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

namespace {

/// Root of the mean histogram, weighted by line, of unit length; zero without lines.
Eigen::RowVectorXf aggregate(const Pgh& pgh) {
  Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(pgh.rows.cols());
  for (Eigen::Index i = 0; i < pgh.rows.rows(); ++i) {
    sum += pgh.weights[i] * pgh.rows.row(i).cwiseAbs2();
  }
  const float total = sum.sum();
  return total > 0 ? Eigen::RowVectorXf((sum / total).cwiseSqrt()) : sum;
}

}  // namespace

HistogramRanker::HistogramRanker(const TopologicalMap& map, const PghOptions& options)
    : options_(options) {
  nodes_.reserve(map.nodes.size());
  for (const MapNode& node : map.nodes) {
    nodes_.push_back(spatial_histograms(node.view.lines, options_));
  }
}

std::vector<RankedNode> HistogramRanker::rank(const PlaceView& view, int most) const {
  const Pgh query = spatial_histograms(view.lines, options_);
  const auto mean = [](const Eigen::VectorXf& best, const Eigen::VectorXf& weights) {
    const float total = weights.sum();
    return total > 0 ? best.dot(weights) / total : 0.0f;
  };
  std::vector<RankedNode> ranked;
  ranked.reserve(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Pgh& node = nodes_[i];
    double score = 0;
    if (node.rows.rows() > 0 && query.rows.rows() > 0) {
      const BestMatches best = best_matches(query.rows, node.rows);
      score = 0.5 * (mean(best.of_queries, query.weights) + mean(best.of_stored, node.weights));
    }
    ranked.push_back({static_cast<int>(i), score, {}});
  }
  return best_of(std::move(ranked), most);
}

AggregateRanker::AggregateRanker(const TopologicalMap& map, const PghOptions& options)
    : options_(options) {
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    const Eigen::RowVectorXf row = aggregate(spatial_histograms(map.nodes[i].view.lines, options_));
    if (i == 0) nodes_.resize(static_cast<Eigen::Index>(map.nodes.size()), row.size());
    nodes_.row(static_cast<Eigen::Index>(i)) = row;
  }
}

std::vector<RankedNode> AggregateRanker::rank(const PlaceView& view, int most) const {
  if (nodes_.rows() == 0) return {};
  const Eigen::RowVectorXf query = aggregate(spatial_histograms(view.lines, options_));
  const Eigen::VectorXf scores = nodes_ * query.transpose();
  std::vector<RankedNode> ranked;
  ranked.reserve(static_cast<std::size_t>(scores.size()));
  for (Eigen::Index i = 0; i < scores.size(); ++i) {
    ranked.push_back({static_cast<int>(i), scores[i], {}});
  }
  return best_of(std::move(ranked), most);
}

}  // namespace vernier::localise::internal
