// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/pgh_localiser.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "localise/alignment.h"
#include "localise/localiser.h"
#include "localise/pgh.h"
#include "localise/place.h"
#include "localise/rank.h"

namespace vernier::localise::internal {

LocalisationAnswer PghLocaliser::localise(const PlaceView& query) const {
  LocalisationAnswer answer;
  if (static_cast<int>(query.lines.size()) < options_.min_lines) return answer;
  const Pgh histograms = spatial_histograms(query.lines, map_.options);
  const std::vector<RankedNode> ranked = rank_nodes(map_, histograms);

  struct Candidate {
    int node;
    double score;
    Pose2D pose;
  };
  std::vector<Candidate> candidates;
  const std::size_t count = std::min<std::size_t>(options_.candidates, ranked.size());
  for (std::size_t i = 0; i < count; ++i) {
    const MapNode& node = map_.nodes[ranked[i].node];
    const Alignment aligned = align(query, node.view);
    candidates.push_back({ranked[i].node, ranked[i].score * aligned.score,
                          compose(node.pose, aligned.query_in_node)});
  }
  if (candidates.empty()) return answer;
  const auto best =
      std::max_element(candidates.begin(), candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  answer.node = best->node;
  answer.pose = best->pose;
  answer.score = best->score;
  for (const Candidate& other : candidates) {
    if (distance_m(other.pose, best->pose) > 1) {
      answer.runner_up = std::max(answer.runner_up, other.score);
    }
  }
  answer.status = !(answer.score > 0)                             ? LocalisationStatus::no_match
                  : answer.runner_up >= answer.score * (1 - 1e-9) ? LocalisationStatus::tie
                                                                  : LocalisationStatus::answered;
  return answer;
}

}  // namespace vernier::localise::internal
