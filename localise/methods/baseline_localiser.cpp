// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/baseline_localiser.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "localise/histograms/best_matches.h"
#include "localise/localiser.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {
namespace {

constexpr int least_baseline_lines = 3;

/// Bhattacharyya coefficient Σ √(p q) of two histograms.
float coefficient(const HistogramRows& P, Eigen::Index p, const HistogramRows& Q, Eigen::Index q) {
  float sum = 0;
  for (Eigen::Index k = 0; k < P.cols(); ++k) sum += std::sqrt(P(p, k) * Q(q, k));
  return sum;
}

/// The filter: score the remaining nodes by the query's lines whose best coefficient exceeds a
/// threshold, drop the lowest node, raise the threshold, until one is left. best(q, n) is the best
/// coefficient of the query's line q among node n's lines.
LocalisationAnswer last_node_left(const Eigen::MatrixXf& best,
                                  const Eigen::VectorXf& weights,
                                  const TopologicalMap& map) {
  LocalisationAnswer answer;
  if (best.cols() == 0 || !(best.maxCoeff() > 0)) {
    answer.status = LocalisationStatus::no_match;
    return answer;
  }
  float threshold = 0.5f;
  const auto score = [&](int n) {
    float sum = 0;
    for (Eigen::Index q = 0; q < best.rows(); ++q) {
      if (best(q, n) > threshold) sum += weights[q] * best(q, n);
    }
    return sum;
  };
  std::vector<int> alive(static_cast<std::size_t>(best.cols()));
  std::iota(alive.begin(), alive.end(), 0);
  std::vector<float> scores;
  while (alive.size() > 1) {
    scores.clear();
    for (const int n : alive) scores.push_back(score(n));
    const auto lowest = std::min_element(scores.begin(), scores.end());
    if (alive.size() == 2) answer.runner_up = *lowest;
    alive.erase(alive.begin() + (lowest - scores.begin()));
    threshold += 0.4f / static_cast<float>(best.cols());
  }
  answer.node = alive[0];
  answer.pose = map.nodes[alive[0]].pose;
  answer.score = score(alive[0]);
  // The threshold has been raised since the last drop; without lines above it there is no decision.
  answer.status = answer.score > 0 ? LocalisationStatus::answered : LocalisationStatus::tie;
  return answer;
}

}  // namespace

BaselineLocaliser::BaselineLocaliser(const TopologicalMap& map, const LocaliserOptions& options)
    : map_(map), options_(options.image_histograms) {
  for (const MapNode& node : map.nodes) {
    histograms_.push_back(plain_histograms(image_histograms(node.view.image_lines, options_)));
  }
}

LocalisationAnswer BaselineLocaliser::localise(const PlaceView& query) const {
  const Pgh lines = image_histograms(query.image_lines, options_);
  if (lines.rows.rows() < least_baseline_lines) return {};
  const HistogramRows of_query = plain_histograms(lines);
  const auto nodes = static_cast<Eigen::Index>(histograms_.size());
  Eigen::MatrixXf best = Eigen::MatrixXf::Zero(of_query.rows(), nodes);
  for (Eigen::Index n = 0; n < nodes; ++n) {
    for (Eigen::Index q = 0; q < of_query.rows(); ++q) {
      for (Eigen::Index m = 0; m < histograms_[n].rows(); ++m) {
        best(q, n) = std::max(best(q, n), coefficient(of_query, q, histograms_[n], m));
      }
    }
  }
  return last_node_left(best, lines.weights, map_);
}

VectorisedBaselineLocaliser::VectorisedBaselineLocaliser(const TopologicalMap& map,
                                                         const LocaliserOptions& options)
    : map_(map), options_(options.image_histograms) {
  for (const MapNode& node : map.nodes) {
    histograms_.push_back(image_histograms(node.view.image_lines, options_));
  }
}

LocalisationAnswer VectorisedBaselineLocaliser::localise(const PlaceView& query) const {
  const Pgh lines = image_histograms(query.image_lines, options_);
  if (lines.rows.rows() < least_baseline_lines) return {};
  const auto nodes = static_cast<Eigen::Index>(histograms_.size());
  Eigen::MatrixXf best(lines.rows.rows(), nodes);
  for (Eigen::Index n = 0; n < nodes; ++n) {
    best.col(n) = best_matches(lines.rows, histograms_[n].rows).of_queries;
  }
  return last_node_left(best, lines.weights, map_);
}

}  // namespace vernier::localise::internal
