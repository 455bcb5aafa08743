// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/baseline_localiser.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "localise/localiser.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {
namespace {

/// Bhattacharyya coefficient Σ √(p q) of two histograms stored as square roots, computed from the
/// squared values as a plain implementation does.
float coefficient(const HistogramRows& P, Eigen::Index p, const HistogramRows& Q, Eigen::Index q) {
  float sum = 0;
  for (Eigen::Index k = 0; k < P.cols(); ++k) {
    const float a = P(p, k) * P(p, k), b = Q(q, k) * Q(q, k);
    sum += std::sqrt(a * b);
  }
  return sum;
}

}  // namespace

BaselineLocaliser::BaselineLocaliser(const TopologicalMap& map, const LocaliserOptions&)
    : map_(map), options_(image_pgh_options()) {
  for (const MapNode& node : map.nodes) {
    histograms_.push_back(image_histograms(node.view.image_lines, options_));
  }
}

LocalisationAnswer BaselineLocaliser::localise(const PlaceView& query) const {
  LocalisationAnswer answer;
  const Pgh lines = image_histograms(query.image_lines, options_);
  if (lines.rows.rows() < 3) return answer;

  // matches(q, n): the query line's best coefficient among node n's lines.
  const auto nodes = static_cast<Eigen::Index>(histograms_.size());
  Eigen::MatrixXf matches = Eigen::MatrixXf::Zero(lines.rows.rows(), nodes);
  for (Eigen::Index n = 0; n < nodes; ++n) {
    for (Eigen::Index q = 0; q < lines.rows.rows(); ++q) {
      for (Eigen::Index m = 0; m < histograms_[n].rows.rows(); ++m) {
        matches(q, n) = std::max(matches(q, n), coefficient(lines.rows, q, histograms_[n].rows, m));
      }
    }
  }
  // The filter: score the remaining nodes by the lines above a threshold, drop the lowest, raise
  // the threshold, until one is left.
  std::vector<int> alive(nodes);
  for (int n = 0; n < static_cast<int>(nodes); ++n) alive[n] = n;
  float threshold = 0.5f;
  const auto score = [&](int n) {
    float sum = 0;
    for (Eigen::Index q = 0; q < matches.rows(); ++q) {
      if (matches(q, n) > threshold) sum += lines.weights[q] * matches(q, n);
    }
    return sum;
  };
  while (alive.size() > 1) {
    const auto lowest = std::min_element(alive.begin(), alive.end(),
                                         [&](int a, int b) { return score(a) < score(b); });
    if (alive.size() == 2) answer.runner_up = score(*lowest);
    alive.erase(lowest);
    threshold += 0.4f / static_cast<float>(nodes);
  }
  if (alive.empty()) return answer;
  answer.node = alive[0];
  answer.pose = map_.nodes[alive[0]].pose;
  answer.score = score(alive[0]);
  // The threshold has been raised since the last drop; without lines above it there is no decision.
  answer.status = answer.score > 0 ? LocalisationStatus::answered : LocalisationStatus::tie;
  return answer;
}

}  // namespace vernier::localise::internal
