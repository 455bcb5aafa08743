// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/line_localiser.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

#include "calib/error.h"
#include "localise/localiser.h"
#include "localise/map/merged_lines.h"
#include "localise/posterior/pose_posterior.h"

namespace vernier::localise::internal {

namespace {

/// Views with fewer lines have many rivals: more of them are compared in full.
constexpr std::size_t sparse_lines = 60;
constexpr int many_finalists = 20;
static const int refine_steps = getenv("RS") ? atoi(getenv("RS")) : 1, rough_steps = getenv("CR") ? atoi(getenv("CR")) : 2, fine_steps = getenv("CF") ? atoi(getenv("CF")) : 4, F0 = getenv("F0") ? atoi(getenv("F0")) : 3;

/// The pose of the first look for a pose of another.
Pose2D first_pose(const Pose2D& pose, double turn_rad) {
  return {pose.x_m, pose.y_m, pose.heading_rad - turn_rad};
}
Pose2D turned(const Pose2D& first, double turn_rad) {
  return {first.x_m, first.y_m, first.heading_rad + turn_rad};
}

bool same_place(const Pose2D& a, const Pose2D& b) {
  constexpr double same_m = 0.15, same_rad = 0.1;
  return distance_m(a, b) < same_m && std::abs(heading_difference_rad(a, b)) < same_rad;
}

bool better(const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; }

}  // namespace

struct LineLocaliser::Query {
  std::vector<Seen> looks;
  std::vector<Hypothesis> compared;  // of the first look's pose
  std::map<int, SpaceLines> merged;  // of nodes, as they are needed
  PredictedLines room;
};

LineLocaliser::LineLocaliser(const TopologicalMap& map, const LocaliserOptions& options)
    : map_(map),
      options_(options),
      ranker_(make_ranker(options.ranker, map, options.histograms)),
      grid_(map),
      search_(map) {
  lines_.reserve(map.nodes.size());
  uprights_.reserve(map.nodes.size());
  for (const MapNode& node : map.nodes) {
    lines_.push_back(space_lines(node.view.lines));
    uprights_.push_back(plan_uprights(node.view.lines));
  }
}

LocalisationAnswer LineLocaliser::localise(const PlaceView& query) const {
  const Look look{query, 0};
  return localise_looks({&look, 1});
}

LocalisationAnswer LineLocaliser::localise_looks(std::span<const Look> looks) const {
  if (looks.empty()) throw Error("looks", "there are none", "give at least one");
  Query query;
  std::size_t lines = 0;
  for (const Look& look : looks) {
    query.looks.push_back(
        {compared_view(look.view), plan_uprights(look.view.lines), look.turn_rad});
    lines += look.view.lines.size();
  }
  LocalisationAnswer nothing;
  if (static_cast<int>(lines) < options_.min_lines) return nothing;
  nothing.status = LocalisationStatus::no_match;
  if (map_.nodes.empty()) return nothing;

  std::vector<Hypothesis> found;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const auto of_look = candidates(query.looks[i], looks[i].view, query);
    found.insert(found.end(), of_look.begin(), of_look.end());
  }
  if (found.empty()) return nothing;
  if (!options_.stages.compare) {
    query.compared = std::move(found);
    return answer(query);
  }
  compare_best(std::move(found), finalists(query), query);
  LocalisationAnswer result = answer(query);
  if (options_.stages.search && result.probability < 1 - std::min(options_.max_error_rate, 0.01)) {
    std::vector<Hypothesis> searched;
    for (const Seen& look : query.looks) {
      for (const Pose2D& pose : search_.poses(look.uprights)) {
        searched.push_back({first_pose(pose, look.turn_rad), -1, 0});
      }
    }
    for (Hypothesis& h : searched) {
      h.score = 0;
      for (const Seen& look : query.looks) {
        const Pose2D pose = turned(h.pose, look.turn_rad);
        const int node = grid_.nearest(pose);
        if (node < 0) continue;
        const ImprovedPose rough =
            improve(look.view, lines_[node], relative(pose, map_.nodes[node].pose), 1,
                    rough_agreement(), query.room);
        h.score += rough.score;
        if (query.looks.size() == 1) {
          h.node = node;
          h.pose = first_pose(compose(map_.nodes[node].pose, rough.pose), look.turn_rad);
        }
      }
    }
    compare_best(std::move(searched), many_finalists, query);
    result = answer(query);
  }
  return result;
}

std::vector<Hypothesis> LineLocaliser::candidates(const Seen& seen,
                                                  const PlaceView& view,
                                                  Query& query) const {
  std::vector<Hypothesis> found;
  for (const RankedNode& ranked : ranker_->rank(view, options_.candidates)) {
    const int node = ranked.node;
    std::vector<Pose2D> starts;
    if (options_.stages.align) {
      for (const VotePeak& peak : vote(seen.uprights, uprights_[node], ranked.turn_rad)) {
        starts.push_back(peak.query_in_node);
      }
    }
    if (starts.empty()) starts.push_back({0, 0, ranked.turn_rad});
    Hypothesis best{{}, node, ranked.score};
    Pose2D in_node = starts[0];
    if (options_.stages.refine) {
      for (std::size_t i = 0; i < starts.size(); ++i) {
        const ImprovedPose refined =
            improve(seen.view, lines_[node], starts[i], refine_steps, rough_agreement(), query.room);
        if (i == 0 || refined.score > best.score) {
          best.score = refined.score;
          in_node = refined.pose;
        }
      }
    }
    best.pose = first_pose(compose(map_.nodes[node].pose, in_node), seen.turn_rad);
    found.push_back(best);
  }
  return found;
}

int LineLocaliser::finalists(const Query& query) const {
  std::size_t lines = 0;
  for (const Seen& look : query.looks) lines = std::max(lines, look.view.lines.size());
  return lines < sparse_lines ? many_finalists : F0;
}

void LineLocaliser::compare_best(std::vector<Hypothesis> candidates, int most, Query& query) const {
  std::stable_sort(candidates.begin(), candidates.end(), better);
  std::vector<Hypothesis> chosen;
  for (const Hypothesis& h : candidates) {
    if (static_cast<int>(chosen.size()) >= most) break;
    const auto same = [&](const Hypothesis& c) { return same_place(c.pose, h.pose); };
    if (std::none_of(chosen.begin(), chosen.end(), same)) chosen.push_back(h);
  }
  for (Hypothesis& h : chosen) {
    compare(h, query);
    query.compared.push_back(h);
  }
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
      auto merged = query.merged.find(node);
      if (merged == query.merged.end()) {
        merged = query.merged.emplace(node, merged_lines(map_, grid_, node)).first;
      }
      lines = &merged->second;
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

LocalisationAnswer LineLocaliser::answer(const Query& query) const {
  LocalisationAnswer result;
  const std::vector<WeightedMode> modes = pose_posterior(query.compared);
  if (modes.empty()) return result;
  for (const WeightedMode& m : modes) {
    result.modes.push_back({m.best.pose, m.best.node, m.probability, m.best.score});
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
      break;
    }
  }
  const bool sure =
      options_.max_error_rate >= 1 || result.probability >= 1 - options_.max_error_rate;
  result.status = sure ? LocalisationStatus::answered : LocalisationStatus::unsure;
  result.next_turn_rad = telling_turn(result.modes, query);
  return result;
}

double LineLocaliser::telling_turn(std::span<const PoseMode> modes, const Query& query) const {
  (void)modes;
  (void)query;
  return 0;
}

}  // namespace vernier::localise::internal
