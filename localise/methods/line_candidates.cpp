// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The first stages of LineLocaliser: where candidates come from, and the best pose around each.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "localise/map/merged_lines.h"
#include "localise/methods/line_localiser.h"
#include "localise/methods/line_query.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"
#include "localise/verification/floor_plan_votes.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

namespace {

/// In large maps further candidates follow, one in so many nodes, at most: of 28,504 nodes all
/// around (offices of seeds 1 to 20), 64 hold the true pose of 78 % of queries, 1024 of 94 %.
constexpr int nodes_per_wide_candidate = 8, most_wide_candidates = 1024;
constexpr std::size_t most_voted = 128;  ///< of these, by votes of uprights
/// Of places that look like another: so many of the best-ranked, so far from it and from each
/// other.
constexpr int ranked_for_rivals = 64, most_rivals = 8;
constexpr double same_place_m = 1.5, rivals_apart_m = 0.75, rivals_apart_rad = 0.25;
/// Gauss-Newton steps of a candidate and, after these, to tell it from others.
constexpr int wide_steps = 2, refine_steps = 1;
/// A candidate whose first comparison is so many nats an observation worse than the best one's is
/// given up: on offices of seeds 2 to 6, 0.5 halved the comparisons and lost none of 250 queries.
constexpr float hopeless_nats = 0.4f;

/// The pose of the first look for a pose of another.
Pose2D first_pose(const Pose2D& pose, double turn_rad) {
  return {pose.x_m, pose.y_m, pose.heading_rad - turn_rad};
}

/// From a pose of votes to one at which candidates can be told apart.
ImprovedPose refine(const ComparedView& view,
                    const SpaceLines& lines,
                    const Pose2D& start,
                    PredictedLines& room) {
  const ImprovedPose wide = improve(view, lines, start, wide_steps, wide_agreement(), room);
  return improve(view, lines, wide.pose, refine_steps, rough_agreement(), room);
}

/// From the best of the poses of votes. Nothing if it is far behind `leader`, the best score of
/// such a pose so far, which it may raise.
std::optional<ImprovedPose> refine_best(const ComparedView& view,
                                        const SpaceLines& lines,
                                        std::span<const VotePeak> starts,
                                        PredictedLines& room,
                                        float& leader) {
  ImprovedPose best;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const ImprovedPose start =
        improve(view, lines, starts[i].query_in_node, 0, wide_agreement(), room);
    if (i == 0 || start.score > best.score) best = start;
  }
  leader = std::max(leader, best.score);
  if (best.score < leader - hopeless_nats * static_cast<float>(view.observations)) return {};
  return refine(view, lines, best.pose, room);
}

}  // namespace

void LineLocaliser::candidates(const Seen& seen,
                               std::span<const RankedNode> ranked,
                               int from,
                               int to,
                               Starts starts,
                               Query& query) const {
  const auto end = std::min<std::size_t>(to, ranked.size());
  for (std::size_t i = from; i < end; ++i) {
    const Pose2D pose = compose(map_.nodes[ranked[i].node].pose, ranked[i].query_in_node);
    if (options_.stages.align) {
      near_pose(pose, seen, starts, query);
    } else {
      query.found.push_back({first_pose(pose, seen.turn_rad), ranked[i].node, ranked[i].score});
    }
  }
}

/// Ranks more candidates than can be compared, and adds those with the most votes of uprights of
/// which none is among those tried before.
void LineLocaliser::wide_candidates(const Seen& seen,
                                    std::span<const RankedNode> ranked_before,
                                    Query& query) const {
  const auto nodes = static_cast<int>(map_.nodes.size());
  const int wide = std::min(most_wide_candidates, nodes / nodes_per_wide_candidate);
  if (wide <= options_.candidates) return;
  const std::vector<RankedNode> ranked = ranker_->rank(*seen.taken, wide);
  struct Voted {
    Pose2D pose;
    float votes;
  };
  std::vector<Voted> voted;
  for (const RankedNode& candidate : ranked) {
    // A longer list need not begin with a shorter one.
    const bool tried = std::any_of(ranked_before.begin(), ranked_before.end(), [&](const auto& t) {
      return t.node == candidate.node && t.query_in_node == candidate.query_in_node;
    });
    if (tried) continue;
    const MapNode& node = map_.nodes[candidate.node];
    const std::vector<VotePeak> peaks =
        vote(seen.uprights, plan_uprights(node.view.lines), candidate.query_in_node);
    if (peaks.empty()) continue;
    voted.push_back({compose(node.pose, candidate.query_in_node), peaks[0].votes});
  }
  std::stable_sort(voted.begin(), voted.end(),
                   [](const Voted& a, const Voted& b) { return a.votes > b.votes; });
  const auto most = std::min(most_voted, voted.size());
  for (std::size_t i = 0; i < most; ++i) near_pose(voted[i].pose, seen, Starts::best, query);
}

/// Adds the best pose around a rough one, by votes and rough comparison with the merged lines of
/// the nearest node, or one from each peak of the votes, however they compare.
void LineLocaliser::near_pose(const Pose2D& pose,
                              const Seen& look,
                              Starts starts,
                              Query& query) const {
  const int node = grid_.nearest(pose);
  if (node < 0) return;
  const SpaceLines& lines = lines_around(node, query);
  const Pose2D around = relative(pose, map_.nodes[node].pose);
  std::vector<VotePeak> peaks = vote(look.uprights, uprights_around(node, query), around);
  if (peaks.empty()) peaks.push_back({around, 0});
  // Candidates beside each other have the same peaks.
  std::erase_if(peaks, [&](const VotePeak& peak) {
    const Pose2D start = compose(map_.nodes[node].pose, peak.query_in_node);
    return !query.started.add(first_pose(start, look.turn_rad));
  });
  if (peaks.empty()) return;
  const auto add = [&](const Pose2D& in_node, double score) {
    const Pose2D at = compose(map_.nodes[node].pose, in_node);
    query.found.push_back({first_pose(at, look.turn_rad), node, score});
  };
  if (!options_.stages.refine) {
    add(peaks[0].query_in_node, peaks[0].votes);
  } else if (starts == Starts::all) {
    for (const VotePeak& peak : peaks) {
      const ImprovedPose refined = refine(look.view, lines, peak.query_in_node, query.room);
      add(refined.pose, refined.score);
    }
  } else if (const auto best = refine_best(look.view, lines, peaks, query.room, query.leader)) {
    add(best->pose, best->score);
  }
}

/// Compares poses from which the map looks as it does from `pose`. The nodes that rank best for a
/// view of few lines may all be of one of several places that are alike, and no other would be
/// compared with it: of 11 wrong answers at a stated 0.5 % in halls of seeds 2 to 4, 8.
void LineLocaliser::compare_rivals(const Pose2D& pose, Query& query) const {
  const int node = grid_.nearest(pose);
  if (node < 0) return;
  const Pose2D in_node = relative(pose, map_.nodes[node].pose);
  const Seen& look = query.looks[0];
  const std::vector<Hypothesis> left = std::exchange(query.found, {});
  TriedPoses tried(rivals_apart_m, rivals_apart_rad);
  int rivals = 0;
  for (const RankedNode& other : ranker_->rank(map_.nodes[node].view, ranked_for_rivals)) {
    if (other.score < ranker_->least_rival_score()) break;
    const Pose2D there =
        compose(compose(map_.nodes[other.node].pose, other.query_in_node), in_node);
    if (distance_m(there, pose) < same_place_m || !tried.add(there)) continue;
    near_pose({there.x_m, there.y_m, there.heading_rad + look.turn_rad}, look, Starts::best, query);
    if (++rivals == most_rivals) break;
  }
  compare_best(most_rivals, query);
  query.found.insert(query.found.end(), left.begin(), left.end());
}

const SpaceLines& LineLocaliser::lines_around(int node, Query& query) const {
  auto merged = query.merged.find(node);
  if (merged == query.merged.end()) {
    merged = query.merged.emplace(node, merged_lines(map_, grid_, node)).first;
  }
  return merged->second;
}

const std::vector<PlanUpright>& LineLocaliser::uprights_around(int node, Query& query) const {
  auto merged = query.uprights.find(node);
  if (merged == query.uprights.end()) {
    merged = query.uprights.emplace(node, plan_uprights(lines_around(node, query))).first;
  }
  return merged->second;
}

}  // namespace vernier::localise::internal
