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
#include "localise/place.h"
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
/// Gauss-Newton steps of a candidate and, after these, of a finalist.
constexpr int wide_steps = 2, refine_steps = 1;
constexpr int rough_steps = 2, fine_steps = 4;
/// A candidate whose first comparison is so many nats an observation worse than the best one's is
/// given up: on offices of seeds 2 to 6, 0.5 halved the comparisons and lost none of 250 queries.
constexpr float hopeless_nats = 0.4f;

/// The pose of the first look for a pose of another.
Pose2D first_pose(const Pose2D& pose, double turn_rad) {
  return {pose.x_m, pose.y_m, pose.heading_rad - turn_rad};
}
Pose2D turned(const Pose2D& first, double turn_rad) {
  return {first.x_m, first.y_m, first.heading_rad + turn_rad};
}

/// Poses that are so close are taken for one.
struct Closeness {
  double distance_m, heading_rad;
};
constexpr Closeness same_start{0.12, 0.05}, same_place{0.15, 0.1};

/// Adds a pose to those tried; false if one of them is close.
bool add_new(std::vector<Pose2D>& tried, const Pose2D& pose, const Closeness& same) {
  const auto is_close = [&](const Pose2D& other) {
    return distance_m(other, pose) < same.distance_m &&
           std::abs(heading_difference_rad(other, pose)) < same.heading_rad;
  };
  if (std::any_of(tried.begin(), tried.end(), is_close)) return false;
  tried.push_back(pose);
  return true;
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

/// Whether two lines are one that is given twice, which is no more evidence.
bool same_line(const PlaceLine& a, const PlaceLine& b) { return a.a_m == b.a_m && a.b_m == b.b_m; }

bool before(const PlaceLine& a, const PlaceLine& b) {
  const auto ends = [](const PlaceLine& l) {
    return std::array{l.a_m.x(), l.a_m.y(), l.a_m.z(), l.b_m.x(), l.b_m.y(), l.b_m.z()};
  };
  return ends(a) < ends(b);
}

bool has_repeats(const PlaceView& view) {
  std::vector<const PlaceLine*> sorted;
  for (const PlaceLine& line : view.lines) sorted.push_back(&line);
  std::sort(sorted.begin(), sorted.end(),
            [](const PlaceLine* a, const PlaceLine* b) { return before(*a, *b); });
  return std::adjacent_find(sorted.begin(), sorted.end(),
                            [](const PlaceLine* a, const PlaceLine* b) {
                              return same_line(*a, *b);
                            }) != sorted.end();
}

void drop_repeats(PlaceView& view) {
  std::sort(view.lines.begin(), view.lines.end(), before);
  view.lines.erase(std::unique(view.lines.begin(), view.lines.end(), same_line), view.lines.end());
}

bool better(const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; }

}  // namespace

struct LineLocaliser::Query {
  std::vector<Seen> looks;
  std::vector<Hypothesis> found, compared;              // of the first look's pose
  std::map<int, SpaceLines> merged;                     // of nodes, as they are needed
  std::map<int, std::vector<PlanUpright>> uprights;     // of these
  std::vector<Pose2D> started, finals;                  // from which poses were refined, compared
  float leader = std::numeric_limits<float>::lowest();  // of the scores there
  PredictedLines room;
};

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
    return !add_new(query.started, first_pose(start, look.turn_rad), same_start);
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

/// Compares the best candidates that are left. Without this stage all are kept as they are.
void LineLocaliser::compare_best(int most, Query& query) const {
  if (!options_.stages.compare) {
    query.compared.insert(query.compared.end(), query.found.begin(), query.found.end());
    query.found.clear();
    return;
  }
  std::stable_sort(query.found.begin(), query.found.end(), better);
  std::vector<Hypothesis> left;
  int compared = 0;
  for (const Hypothesis& h : query.found) {
    if (compared >= most) {
      left.push_back(h);
      continue;
    }
    if (!add_new(query.finals, h.pose, same_place)) continue;
    query.compared.push_back(h);
    compare(query.compared.back(), query);
    ++compared;
  }
  query.found = std::move(left);
}

/// The score of all looks with the merged lines of the nodes nearest to the pose, which is
/// improved by steps on the sum: rough ones, whose score is not kept, then fine ones.
void LineLocaliser::compare(Hypothesis& hypothesis, Query& query) const {
  const AgreementOptions rough = rough_agreement(), fine = fine_agreement();
  Pose2D at = hypothesis.pose;
  for (int step = 0; step <= rough_steps + fine_steps; ++step) {
    const bool is_fine = step >= rough_steps;
    const JointAgreement here = joint_agreement(at, is_fine ? fine : rough, query);
    if (step == rough_steps || (is_fine && here.score > hypothesis.score)) {
      hypothesis = {at, here.node >= 0 ? here.node : hypothesis.node, here.score};
    } else if (is_fine) {
      break;
    }
    const Eigen::Vector3f move = (here.information + step_damping()).inverse() * here.gradient;
    if (move.allFinite()) at = compose(at, {move[0], move[1], move[2]});
  }
}

/// Scores and derivatives of all looks with respect to the pose of the first.
LineLocaliser::JointAgreement LineLocaliser::joint_agreement(const Pose2D& first,
                                                             const AgreementOptions& options,
                                                             Query& query) const {
  static const SpaceLines nothing_known = space_lines({});
  JointAgreement sum;
  for (const Seen& look : query.looks) {
    const Pose2D pose = turned(first, look.turn_rad);
    const int node = grid_.nearest(pose);
    if (&look == query.looks.data()) sum.node = node;
    const SpaceLines* lines = &nothing_known;
    Pose2D in_node;
    if (node >= 0) {
      lines = &lines_around(node, query);
      in_node = relative(pose, map_.nodes[node].pose);
    }
    const ViewAgreement here = agreement(look.view, *lines, in_node, options, query.room);
    sum.score += here.score;
    // A step of the first look in the frame of this one.
    const auto c = static_cast<float>(std::cos(look.turn_rad));
    const auto s = static_cast<float>(std::sin(look.turn_rad));
    Eigen::Matrix3f T = Eigen::Matrix3f::Identity();
    T.topLeftCorner<2, 2>() << c, s, -s, c;
    sum.gradient += T.transpose() * here.gradient;
    sum.information += T.transpose() * here.information * T;
  }
  return sum;
}

LocalisationAnswer LineLocaliser::answer(Query& query, double off_map) const {
  LocalisationAnswer result;
  PosteriorOptions posterior;
  posterior.off_map = off_map;
  double observations = 0;
  for (const Seen& look : query.looks) observations += look.view.observations;
  const std::vector<WeightedMode> modes =
      pose_posterior(query.compared, observations, map_.nodes.size(), posterior);
  if (modes.empty()) return result;
  for (const WeightedMode& m : modes) {
    // Only scores of the last comparison are log-likelihoods.
    constexpr double negligible = 1e-3;
    const double probability = !options_.stages.compare ? 0
                               : m.probability < negligible
                                   ? m.probability
                                   : m.probability * share_within_success(m.best.pose, query);
    result.modes.push_back({m.best.pose, m.best.node, probability, m.best.score});
  }
  if (!options_.stages.compare) {
    std::stable_sort(result.modes.begin(), result.modes.end(),
                     [](const PoseMode& a, const PoseMode& b) { return a.score > b.score; });
  }
  const PoseMode& best = result.modes[0];
  result.node = best.node;
  result.pose = best.pose;
  result.score = best.score;
  result.probability = best.probability;
  constexpr double no_rival_nats = 100;
  result.runner_up = best.score - no_rival_nats;
  for (const PoseMode& mode : result.modes) {
    if (distance_m(mode.pose, best.pose) > 1) {
      result.runner_up = std::max(result.runner_up, mode.score);
    }
  }
  const bool sure =
      options_.max_error_rate >= 1 || result.probability >= 1 - options_.max_error_rate;
  result.status = sure ? LocalisationStatus::answered : LocalisationStatus::unsure;
  return result;
}

/// How much of a mode lies within 1 m of its pose, by its least certain direction on the floor: a
/// view of one upright line fits a circle of poses, and the best of those that were tried is one.
double LineLocaliser::share_within_success(const Pose2D& pose, Query& query) const {
  constexpr double success_m = 1;
  const Eigen::Matrix3d information =
      joint_agreement(pose, fine_agreement(), query).information.cast<double>();
  const double of_heading = information(2, 2);
  if (!(of_heading > 0)) return 0;
  // of the position, whatever the heading is
  const Eigen::Matrix2d of_position =
      information.topLeftCorner<2, 2>() -
      information.topRightCorner<2, 1>() * information.bottomLeftCorner<1, 2>() / of_heading;
  const double half_trace = 0.5 * of_position.trace();
  const double least =
      half_trace - std::sqrt(std::max(0.0, half_trace * half_trace - of_position.determinant()));
  return least > 0 ? std::erf(success_m * std::sqrt(0.5 * least)) : 0;
}

/// The turn at which the two best modes would see what explains the other's view least.
double LineLocaliser::telling_turn(std::span<const PoseMode> modes, Query& query) const {
  const auto rival = std::find_if(modes.begin(), modes.end(), [&](const PoseMode& mode) {
    return distance_m(mode.pose, modes[0].pose) > 1;
  });
  if (rival == modes.end()) return 0;
  constexpr double degree = std::numbers::pi / 180;
  constexpr double known_rad = 15 * degree;  // closer to a look that was taken: nothing new
  const ViewCamera& camera = query.looks[0].view.camera;
  double best = 0, least = 0;
  for (const double turn_deg : {20, -20, 45, -45, 90, -90, 135, -135, 180}) {
    const double turn = turn_deg * degree;
    const bool taken = std::any_of(query.looks.begin(), query.looks.end(), [&](const Seen& look) {
      return std::abs(std::remainder(look.turn_rad - turn, 2 * std::numbers::pi)) < known_rad;
    });
    const Pose2D here = turned(modes[0].pose, turn), there = turned(rival->pose, turn);
    const int a = grid_.nearest(here), b = grid_.nearest(there);
    if (taken || a < 0 || b < 0) continue;
    const SpaceLines &lines_a = lines_around(a, query), &lines_b = lines_around(b, query);
    const Pose2D in_a = relative(here, map_.nodes[a].pose);
    const Pose2D in_b = relative(there, map_.nodes[b].pose);
    const ComparedView view_a = predicted_view(lines_a, in_a, camera, query.room);
    const ComparedView view_b = predicted_view(lines_b, in_b, camera, query.room);
    const double score = agreement(view_a, lines_b, in_b, fine_agreement(), query.room).score +
                         agreement(view_b, lines_a, in_a, fine_agreement(), query.room).score;
    if (score < least) {
      least = score;
      best = turn;
    }
  }
  return best;
}

}  // namespace vernier::localise::internal
