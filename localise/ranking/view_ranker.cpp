// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/view_ranker.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "localise/place.h"
#include "localise/ranking/coarse_panorama.h"
#include "localise/ranking/node_ranker.h"
#include "localise/ranking/panorama.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

ViewRanker::ViewRanker(const TopologicalMap& map)
    : map_(map), grid_(map), in_view_(bearings_in_view(map)) {
  constexpr double same_position_m = 0.05, any_turn_rad = 4;
  std::vector<bool> done(map.nodes.size(), false);
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    if (done[i]) continue;
    std::vector<const MapNode*> here;
    for (const int k : grid_.near(map.nodes[i].pose, same_position_m, any_turn_rad)) {
      if (done[k]) continue;
      done[k] = true;
      here.push_back(&map.nodes[k]);
    }
    places_.push_back(panoramas(here, in_view_));
    coarse_.add(places_.back().front());
  }
}

std::vector<RankedNode> ViewRanker::rank(const PlaceView& query, int most) const {
  if (most <= 0) return {};
  const std::vector<float> descriptor = view_descriptor(query.lines, in_view_);
  constexpr std::size_t least_tried = 512, tried_per_answer = 3;
  constexpr int reach = 3;  // of fine bins around a coarse window
  const std::size_t tried =
      std::max(least_tried, tried_per_answer * static_cast<std::size_t>(most));
  struct Found {
    Pose2D pose;
    float likeness;
  };
  std::vector<Found> found;
  for (const CoarseMatch& coarse : coarse_.best(CoarseView(descriptor), tried)) {
    for (const Panorama& panorama : places_[coarse.place]) {
      const PanoramaMatch match = best_match(descriptor, panorama, coarse.bearing, reach);
      if (!(match.likeness > 0)) continue;
      found.push_back({{panorama.at.x_m, panorama.at.y_m, match.heading_rad}, match.likeness});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.likeness > b.likeness; });
  // Neighbours look alike: of poses close to each other the best is kept.
  constexpr double apart_m = 0.5, apart_rad = 0.25;
  std::vector<RankedNode> ranked;
  std::vector<Pose2D> kept;
  for (const auto& [pose, likeness] : found) {
    if (static_cast<int>(ranked.size()) == most) break;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&, &pose = pose](const Pose2D& k) {
      const double dx = k.x_m - pose.x_m, dy = k.y_m - pose.y_m;
      return dx * dx + dy * dy < apart_m * apart_m &&
             std::abs(heading_difference_rad(k, pose)) < apart_rad;
    });
    if (!is_new) continue;
    const int node = grid_.nearest(pose);
    if (node < 0) continue;
    kept.push_back(pose);
    ranked.push_back({node, likeness, relative(pose, map_.nodes[node].pose)});
  }
  return ranked;
}

}  // namespace vernier::localise::internal
