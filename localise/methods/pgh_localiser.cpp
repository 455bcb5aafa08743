// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/pgh_localiser.h"

#include <algorithm>
#include <vector>

#include "localise/localiser.h"
#include "localise/place.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"
#include "localise/verification/alignment.h"

namespace vernier::localise::internal {

LocalisationAnswer PghLocaliser::localise(const PlaceView& query) const {
  LocalisationAnswer answer;
  constexpr int least_lines = 6;  // of histograms, whatever the option says
  if (static_cast<int>(query.lines.size()) < std::max(options_.min_lines, least_lines))
    return answer;
  const std::vector<RankedNode> ranked =
      ranker_.rank(query, std::min(options_.candidates, most_candidates));

  struct Candidate {
    int node;
    double score;
    Pose2D pose;
  };
  std::vector<Candidate> candidates;
  for (const RankedNode& near : ranked) {
    const MapNode& node = map_.nodes[near.node];
    const Alignment aligned = align(query, node.view);
    candidates.push_back(
        {near.node, near.score * aligned.score, compose(node.pose, aligned.query_in_node)});
  }
  if (candidates.empty()) {
    answer.status = LocalisationStatus::no_match;
    return answer;
  }
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
