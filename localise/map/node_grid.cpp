// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map/node_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

NodeGrid::Cell NodeGrid::cell(const Pose2D& pose) {
  const double most = 1e9;  // of cells; further away nodes share these
  const auto index = [most](double m) {
    return static_cast<std::int64_t>(std::clamp(std::floor(m / cell_m_), -most, most));
  };
  const bool finite = std::isfinite(pose.x_m) && std::isfinite(pose.y_m);
  return finite ? Cell{index(pose.x_m), index(pose.y_m)} : Cell{};
}

std::uint64_t NodeGrid::key(std::int64_t x, std::int64_t y) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32 |
         static_cast<std::uint32_t>(y);
}

NodeGrid::NodeGrid(const TopologicalMap& map) : map_(map) {
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    const Cell at = cell(map.nodes[i].pose);
    cells_[key(at.x, at.y)].push_back(static_cast<int>(i));
  }
}

void NodeGrid::visit(const Pose2D& pose, const std::function<void(int)>& node) const {
  const Cell at = cell(pose);
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const auto found = cells_.find(key(at.x + dx, at.y + dy));
      if (found == cells_.end()) continue;
      for (const int i : found->second) node(i);
    }
  }
}

std::vector<int> NodeGrid::near(const Pose2D& pose, double radius_m, double turn_rad) const {
  std::vector<int> nodes;
  visit(pose, [&](int i) {
    const Pose2D& at = map_.nodes[i].pose;
    if (distance_m(at, pose) <= radius_m &&
        std::abs(heading_difference_rad(at, pose)) <= turn_rad) {
      nodes.push_back(i);
    }
  });
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

int NodeGrid::nearest(const Pose2D& pose, int left_out) const {
  constexpr double most_m = 2, most_rad = 0.6, metres_per_rad = 0.5;
  int best = -1;
  double least = 0;
  for (const int i : near(pose, most_m, most_rad)) {
    if (i == left_out) continue;
    const Pose2D& at = map_.nodes[i].pose;
    const double cost =
        distance_m(at, pose) + metres_per_rad * std::abs(heading_difference_rad(at, pose));
    if (best < 0 || cost < least) {
      best = i;
      least = cost;
    }
  }
  return best;
}

}  // namespace vernier::localise::internal
