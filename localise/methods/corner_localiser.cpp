// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/methods/corner_localiser.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/statistics/distributions.h"
#include "localise/localiser.h"
#include "localise/odometry.h"
#include "localise/odometry/floor_step.h"
#include "localise/odometry/mutual_links.h"
#include "localise/odometry/pair_projection.h"
#include "localise/odometry/step_consensus.h"
#include "localise/place.h"
#include "localise/place/corner_check.h"
#include "localise/ranking/corner_index.h"
#include "localise/ranking/node_ranker.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

namespace {

using Eigen::MatrixXf;

constexpr std::size_t settled = 6;
/// Of every pixel, beyond the noise of corners: what errors of the calibration do to them.
constexpr double calibration_sigma_px = 0.5;
/// A second place with so much of the best one's support could be it as well.
constexpr double tie_share = 0.8;

constexpr CornerLinkOptions linking{.min_similarity = 0.7, .min_margin = 0.05};

StepOptions step_options(const LocaliserOptions& options) {
  StepOptions step;
  step.max_draws = 100;
  step.min_inliers = options.min_corners;
  return step;
}

/// A corner for matching: its covariance widened by the calibration's part, its descriptor left
/// out.
StereoCorner tolerant(const StereoCorner& corner) {
  return {corner.left_px,
          corner.right_px,
          corner.covariance_px2 +
              calibration_sigma_px * calibration_sigma_px * Eigen::Matrix4d::Identity(),
          {}};
}

/// Throws Error unless the corners are ones of a rig of two cameras.
void check(const PlaceView& view, const std::string& place) {
  if (view.corners.empty()) return;
  if (!view.rig || view.rig->cameras.size() != 2 || view.rig->T_camera_first.size() != 2) {
    throw Error(place, "has corners and no rig of two cameras", "set PlaceView::rig");
  }
  check_corners(view.corners, place);
}

}  // namespace

/// A query as it is compared.
struct CornerLocaliser::Seen {
  const PlaceView& view;
  MatrixXf descriptors;
  std::vector<StereoCorner> corners;                      // tolerant
  std::vector<std::optional<TriangulatedCorner>> points;  // of them
};

/// A node with the motion on which its links with the query agree.
struct CornerLocaliser::Candidate {
  int node = -1;
  std::vector<TriangulatedLink> links;
  Pose T_node_query;  // of the left cameras
  double support = 0;
  Pose2D pose;
};

CornerLocaliser::CornerLocaliser(const TopologicalMap& map, const LocaliserOptions& options)
    : map_(map), options_(options), index_(map) {
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    check(map.nodes[i].view, "map node " + std::to_string(i));
  }
}

std::optional<CornerLocaliser::Candidate> CornerLocaliser::candidate(int node,
                                                                     const Seen& seen) const {
  const MapNode& known = map_.nodes[node];
  const MatrixXf descriptors =
      descriptor_columns(known.view.corners, index_.descriptor_size(), "map node");
  const MatrixXf similar = descriptors.transpose() * seen.descriptors;
  const auto fewest = static_cast<std::size_t>(options_.min_corners);
  const std::vector<CornerLink> links = mutual_links(
      known.view.corners.size(), seen.corners.size(), linking, [&](std::size_t i, std::size_t j) {
        return similar(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      });
  if (links.size() < fewest) return std::nullopt;

  const StepOptions step = step_options(options_);
  const double gate = vernier::internal::chi_squared_quantile(step.gate_probability, 1);
  PairProjector projector(*known.view.rig);
  Candidate found;
  found.node = node;
  for (const CornerLink& link : links) {
    const auto& later = seen.points[static_cast<std::size_t>(link.to)];
    if (!later) continue;
    const StereoCorner from = tolerant(known.view.corners[static_cast<std::size_t>(link.from)]);
    const auto earlier = triangulated(projector, from, {}, gate);
    if (!earlier) continue;
    found.links.push_back(triangulated_link(
        link, from, *earlier, seen.corners[static_cast<std::size_t>(link.to)], *later));
  }
  const FloorViews views{{*known.view.rig, *seen.view.rig}, known.view.mount, seen.view.mount};
  found.links = level_links(views, std::move(found.links), step.gate_probability);
  if (found.links.size() < fewest) return std::nullopt;
  const auto agreed = floor_consensus(views, found.links, step);
  if (!agreed) return std::nullopt;
  found.T_node_query = agreed->T_from_to;
  found.support =
      static_cast<double>(found.links.size()) - agreed->sum / link_gate(step.gate_probability);
  found.pose = compose(known.pose, robot_step(views, agreed->T_from_to));
  return found;
}

LocalisationAnswer CornerLocaliser::answer(std::vector<Candidate> candidates,
                                           const Seen& seen) const {
  LocalisationAnswer answer;
  answer.status = LocalisationStatus::no_match;
  const auto better = [](const Candidate& a, const Candidate& b) { return a.support > b.support; };
  std::stable_sort(candidates.begin(), candidates.end(), better);
  const StepOptions step = step_options(options_);
  for (std::size_t i = 0; i < std::min(settled, candidates.size()); ++i) {
    Candidate& tried = candidates[i];
    const MapNode& known = map_.nodes[tried.node];
    const FloorViews views{{*known.view.rig, *seen.view.rig}, known.view.mount, seen.view.mount};
    const auto found = floor_step(views, tried.links, tried.T_node_query, step);
    if (!found) continue;
    tried.support = found->support;
    tried.pose = compose(known.pose, found->to_in_from);
    if (found->support <= answer.score) continue;
    answer.status = LocalisationStatus::answered;
    answer.node = tried.node;
    answer.pose = tried.pose;
    answer.score = found->support;
  }
  if (answer.status == LocalisationStatus::no_match) return answer;
  for (const Candidate& other : candidates) {
    if (distance_m(other.pose, answer.pose) > 1) {
      answer.runner_up = std::max(answer.runner_up, other.support);
    }
  }
  if (answer.runner_up >= tie_share * answer.score) answer.status = LocalisationStatus::tie;
  return answer;
}

LocalisationAnswer CornerLocaliser::localise(const PlaceView& query) const {
  check(query, "query");
  LocalisationAnswer none;
  none.status = LocalisationStatus::too_few_corners;
  if (static_cast<int>(query.corners.size()) < options_.min_corners) return none;
  none.status = LocalisationStatus::no_match;
  if (index_.descriptor_size() == 0) return none;

  const StepOptions step = step_options(options_);
  const double gate = vernier::internal::chi_squared_quantile(step.gate_probability, 1);
  Seen seen{query, descriptor_columns(query.corners, index_.descriptor_size(), "query"), {}, {}};
  PairProjector projector(*query.rig);
  for (const StereoCorner& corner : query.corners) {
    seen.corners.push_back(tolerant(corner));
    seen.points.push_back(triangulated(projector, seen.corners.back(), {}, gate));
  }
  std::vector<Candidate> candidates;
  for (const RankedNode& near :
       index_.rank(seen.descriptors, std::min(options_.candidates, most_candidates))) {
    if (auto found = candidate(near.node, seen)) candidates.push_back(std::move(*found));
  }
  return answer(std::move(candidates), seen);
}

}  // namespace vernier::localise::internal
