// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/ranking/view_ranker.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "localise/place.h"
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
    for (Panorama& panorama : panoramas(here, in_view_)) panoramas_.push_back(std::move(panorama));
  }
}

std::vector<RankedNode> ViewRanker::rank(const PlaceView& query, int most) const {
  const std::vector<float> descriptor = view_descriptor(query.lines, in_view_);
  std::vector<PanoramaMatch> found = matches(descriptor, panoramas_);
  const auto better = [](const PanoramaMatch& a, const PanoramaMatch& b) {
    return a.likeness != b.likeness ? a.likeness > b.likeness : a.panorama < b.panorama;
  };
  // Neighbours look alike: of poses close to each other the best is kept.
  constexpr double apart_m = 0.5, apart_rad = 0.25;
  constexpr std::size_t spare = 8;
  const std::size_t sorted =
      std::min(found.size(), spare * static_cast<std::size_t>(std::max(most, 0)));
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(sorted), found.end(),
                    better);
  std::vector<RankedNode> ranked;
  std::vector<Pose2D> kept;
  for (std::size_t i = 0; i < sorted && static_cast<int>(ranked.size()) < most; ++i) {
    Pose2D pose = panoramas_[found[i].panorama].at;
    pose.heading_rad = found[i].heading_rad;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const Pose2D& k) {
      return distance_m(k, pose) < apart_m && std::abs(heading_difference_rad(k, pose)) < apart_rad;
    });
    if (!is_new) continue;
    const int node = grid_.nearest(pose);
    if (node < 0) continue;
    kept.push_back(pose);
    ranked.push_back({node, found[i].likeness, relative(pose, map_.nodes[node].pose)});
  }
  return ranked;
}

}  // namespace vernier::localise::internal
