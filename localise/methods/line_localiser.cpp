// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/line_localiser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/map/merged_lines.h"
#include "localise/methods/line_query.h"
#include "localise/place.h"
#include "localise/place/repeated_lines.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"
#include "localise/verification/floor_plan_votes.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

namespace {

/// Views with fewer lines have many rivals: more of them are compared in full.
constexpr std::size_t sparse_lines = 60;
constexpr int few_finalists = 3, many_finalists = 20;
constexpr int first_candidates = 16;  ///< the others follow where these leave doubts
/// In large maps further candidates follow, one in so many nodes, at most: of 28,504 nodes all
/// around (offices of seeds 1 to 20), 64 hold the true pose of 78 % of queries, 1024 of 94 %.
constexpr int nodes_per_wide_candidate = 8, most_wide_candidates = 1024;
constexpr double sure_error_rate = 0.01;  ///< unless a smaller one is asked for
/// Gauss-Newton steps of a candidate and, after these, to tell it from others.
constexpr int wide_steps = 2, refine_steps = 1;
/// A candidate whose first comparison is so many nats an observation worse than the best one's is
/// given up: on offices of seeds 2 to 6, 0.5 halved the comparisons and lost none of 250 queries.
constexpr float hopeless_nats = 0.4f;

/// The pose of the first look for a pose of another.
Pose2D first_pose(const Pose2D& pose, double turn_rad) {
  return {pose.x_m, pose.y_m, pose.heading_rad - turn_rad};
}
/// From the best of the poses of votes to one at which candidates can be told apart. Nothing if it
/// is far behind `leader`, the best score of such a pose so far, which it may raise.
std::optional<ImprovedPose> refine(const ComparedView& view,
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
  best = improve(view, lines, best.pose, wide_steps, wide_agreement(), room);
  return improve(view, lines, best.pose, refine_steps, rough_agreement(), room);
}

}  // namespace

LineLocaliser::LineLocaliser(const TopologicalMap& map, const LocaliserOptions& options)
    : map_(map),
      options_(options),
      ranker_(make_ranker(options.ranker, map, options.histograms)),
      grid_(map) {
  const double least = least_error_rate(map.nodes.size());
  if (options.stages.compare && options.max_error_rate < least) {
    throw Error(
        "max_error_rate",
        fmt::format("{:g} is below {:.2g}, the least that can be stated in a map of {} nodes",
                    options.max_error_rate, least, map.nodes.size()),
        "use a larger one");
  }
}

LocalisationAnswer LineLocaliser::localise(const PlaceView& query) const {
  const Look look{query, 0};
  return localise_looks({&look, 1});
}

LocalisationAnswer LineLocaliser::localise_looks(std::span<const Look> looks) const {
  if (looks.empty()) throw Error("looks", "there are none", "give at least one");
  if (std::any_of(looks.begin(), looks.end(), [](const Look& l) { return has_repeats(l.view); })) {
    std::vector<Look> once(looks.begin(), looks.end());
    for (Look& look : once) drop_repeats(look.view);
    return localise_looks(once);
  }
  Query query;
  std::size_t lines = 0;
  for (const Look& look : looks) {
    query.looks.push_back(
        {&look.view, compared_view(look.view), plan_uprights(look.view.lines), look.turn_rad});
    lines += look.view.lines.size();
  }
  LocalisationAnswer nothing;
  if (static_cast<int>(lines) < options_.min_lines) return nothing;
  nothing.status = LocalisationStatus::no_match;
  if (map_.nodes.empty()) return nothing;

  std::vector<std::vector<RankedNode>> ranked;
  for (const Look& look : looks) ranked.push_back(ranker_->rank(look.view, options_.candidates));

  LocalisationAnswer result = search(ranked, query);
  if (result.status == LocalisationStatus::unsure) {
    result.next_turn_rad = telling_turn(result.modes, query);
  }
  return result;
}

/// Tries more of everything as long as the answer is not sure. `ranked` is of each look.
LocalisationAnswer LineLocaliser::search(std::span<const std::vector<RankedNode>> ranked,
                                         Query& query) const {
  struct Round {
    int candidates, finalists;
    bool wide = false;
  };
  const int first = std::min(options_.candidates, first_candidates);
  const int few = is_plain(query) ? few_finalists : many_finalists;
  std::vector<Round> rounds{{first, few}};
  if (options_.stages.deepen) {
    if (few < many_finalists) rounds.push_back({first, many_finalists - few});
    rounds.push_back({options_.candidates, many_finalists});
    if (options_.stages.align) rounds.push_back({options_.candidates, many_finalists, true});
  }
  const double sure = 1 - std::max(std::min(options_.max_error_rate, sure_error_rate),
                                   least_error_rate(map_.nodes.size()));
  LocalisationAnswer result;
  result.status = LocalisationStatus::no_match;
  int tried = 0;
  for (const Round& round : rounds) {
    for (std::size_t i = 0; i < query.looks.size(); ++i) {
      candidates(query.looks[i], ranked[i], tried, round.candidates, query);
      if (round.wide) wide_candidates(query.looks[i], ranked[i], query);
    }
    tried = round.candidates;
    compare_best(round.finalists, query);
    if (query.compared.empty()) continue;
    result = answer(query, 0);
    if (result.probability >= sure) break;
  }
  // More candidates do not help against a place that the map does not hold.
  if (options_.off_map > 0 && !query.compared.empty()) result = answer(query, options_.off_map);
  return result;
}

void LineLocaliser::candidates(
    const Seen& seen, std::span<const RankedNode> ranked, int from, int to, Query& query) const {
  const auto end = std::min<std::size_t>(to, ranked.size());
  for (std::size_t i = from; i < end; ++i) {
    const Pose2D pose = compose(map_.nodes[ranked[i].node].pose, ranked[i].query_in_node);
    if (options_.stages.align) {
      near_pose(pose, seen, query);
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
  const auto most = std::min<std::size_t>(2 * options_.candidates, voted.size());
  for (std::size_t i = 0; i < most; ++i) near_pose(voted[i].pose, seen, query);
}

/// Adds the best pose around a rough one, by votes and rough comparison with the merged lines of
/// the nearest node.
void LineLocaliser::near_pose(const Pose2D& pose, const Seen& look, Query& query) const {
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
  ImprovedPose best{peaks[0].query_in_node, peaks[0].votes, {}};
  if (options_.stages.refine) {
    const auto refined = refine(look.view, lines, peaks, query.room, query.leader);
    if (!refined) return;
    best = *refined;
  }
  query.found.push_back(
      {first_pose(compose(map_.nodes[node].pose, best.pose), look.turn_rad), node, best.score});
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

bool LineLocaliser::is_plain(const Query& query) const {
  // A candidate of one look was not compared with the others yet.
  return query.looks.size() == 1 && query.looks[0].view.lines.size() >= sparse_lines;
}

}  // namespace vernier::localise::internal
