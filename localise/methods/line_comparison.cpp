// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// The last stage of LineLocaliser: candidates compared in full, and what is answered.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "localise/localiser.h"
#include "localise/methods/line_localiser.h"
#include "localise/methods/line_query.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/place/view_camera.h"
#include "localise/posterior/pose_posterior.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"
#include "localise/verification/image_lines.h"
#include "localise/verification/place_evidence.h"
#include "localise/verification/view_agreement.h"

namespace vernier::localise::internal {

namespace {

constexpr int rough_steps = 2, fine_steps = 4;  // Gauss-Newton steps of a finalist

bool better(const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; }

/// How much of a mode lies within 1 m of its pose, by its least certain direction on the floor: a
/// view of one upright line fits a circle of poses, and the best of those that were tried is one.
double share_within_success(const Eigen::Matrix3f& information_of_pose) {
  constexpr double success_m = 1;
  const Eigen::Matrix3d information = information_of_pose.cast<double>();
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

}  // namespace

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
    if (!query.finals.add(h.pose)) continue;
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
      hypothesis = {at, here.node >= 0 ? here.node : hypothesis.node, here.score, here.information};
    } else if (is_fine) {
      break;
    }
    const Eigen::Vector3f move = (here.information + step_damping()).inverse() * here.gradient;
    if (move.allFinite()) at = compose(at, {move[0], move[1], move[2]});
  }
}

/// What the map holds around a pose; no lines where it holds nothing.
LineLocaliser::MapPart LineLocaliser::map_part(const Pose2D& pose, Query& query) const {
  static const SpaceLines nothing_known = space_lines({});
  const int node = grid_.nearest(pose);
  if (node < 0) return {-1, &nothing_known, {}};
  return {node, &lines_around(node, query), relative(pose, map_.nodes[node].pose)};
}

/// Scores and derivatives of all looks with respect to the pose of the first.
LineLocaliser::JointAgreement LineLocaliser::joint_agreement(const Pose2D& first,
                                                             const AgreementOptions& options,
                                                             Query& query) const {
  JointAgreement sum;
  for (const Seen& look : query.looks) {
    const MapPart part = map_part(turned(first, look.turn_rad), query);
    if (&look == query.looks.data()) sum.node = part.node;
    const ViewAgreement here =
        agreement(look.view, *part.lines, part.pose_in_node, options, query.room);
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
  EvidenceBetween between;
  if (options_.stages.compare && options_.repeats > 0) {
    between = [&](const Hypothesis& a, const Hypothesis& b) { return evidence(a, b, query); };
  }
  const std::vector<WeightedMode> modes =
      pose_posterior(query.compared, size_of(query), map_.nodes.size(), posterior, between);
  if (modes.empty()) return result;
  for (const WeightedMode& m : modes) {
    // Only scores of the last comparison are log-likelihoods.
    constexpr double least = 1e-12;  // 0 would say that none is stated
    const double probability =
        options_.stages.compare
            ? std::max(m.probability * share_within_success(m.best.information), least)
            : 0;
    result.modes.push_back({m.best.pose, m.best.node, probability, m.best.score});
  }
  std::stable_sort(
      result.modes.begin(), result.modes.end(), [&](const PoseMode& a, const PoseMode& b) {
        return options_.stages.compare ? a.probability > b.probability : a.score > b.score;
      });
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

/// The turn at which the two best modes would see what explains the other's view least. Where there
/// are no two, places that rank best for the first look stand for them, else any. 0 if none tells.
double LineLocaliser::telling_turn(std::span<const PoseMode> modes,
                                   std::span<const RankedNode> ranked,
                                   Query& query) const {
  constexpr double degree = std::numbers::pi / 180;
  constexpr double known_rad = 15 * degree;  // closer to a look that was taken: nothing new
  std::vector<Pose2D> poses;
  for (const PoseMode& mode : modes) poses.push_back(mode.pose);
  for (const RankedNode& place : ranked) {
    poses.push_back(compose(map_.nodes[place.node].pose, place.query_in_node));
  }
  const auto far_from_first = [&] {
    return std::find_if(poses.begin(), poses.end(),
                        [&](const Pose2D& pose) { return distance_m(pose, poses[0]) > 1; });
  };
  auto rival = far_from_first();
  if (rival == poses.end()) {
    for (const MapNode& node : map_.nodes) poses.push_back(node.pose);
    rival = far_from_first();
  }
  if (rival == poses.end()) return 0;
  const ViewCamera& camera = query.looks[0].view.camera;
  double best = 0, least = 0;
  for (const double turn_deg : {20, -20, 45, -45, 90, -90, 135, -135, 180}) {
    const double turn = turn_deg * degree;
    const bool taken = std::any_of(query.looks.begin(), query.looks.end(), [&](const Seen& look) {
      return std::abs(std::remainder(look.turn_rad - turn, 2 * std::numbers::pi)) < known_rad;
    });
    if (taken) continue;
    const MapPart a = map_part(turned(poses[0], turn), query);
    if (a.node < 0) continue;
    const MapPart b = map_part(turned(*rival, turn), query);
    if (b.node < 0) continue;
    const ComparedView view_a = predicted_view(*a.lines, a.pose_in_node, camera, query.room);
    const ComparedView view_b = predicted_view(*b.lines, b.pose_in_node, camera, query.room);
    const AgreementOptions options = fine_agreement();
    const double score = agreement(view_a, *b.lines, b.pose_in_node, options, query.room).score +
                         agreement(view_b, *a.lines, a.pose_in_node, options, query.room).score;
    if (score < least) {
      least = score;
      best = turn;
    }
  }
  return best;
}

}  // namespace vernier::localise::internal
