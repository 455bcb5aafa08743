// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map/merged_lines.h"

#include <cmath>

#include "localise/map/known_lines.h"
#include "localise/map/node_grid.h"
#include "localise/place.h"
#include "localise/place/space_lines.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

SpaceLines merged_lines(const TopologicalMap& map, const NodeGrid& grid, int node, int left_out) {
  constexpr double radius_m = 1.1, turn_rad = 1.05;
  SpaceLines lines;
  KnownLines known;
  const auto add = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, float sigma,
                       bool counted) {
    lines.add(a, b, sigma, counted);
    known.add(a, b, sigma);
  };
  for (const PlaceLine& line : map.nodes[node].view.lines) {
    add(line.a_m.cast<float>(), line.b_m.cast<float>(), static_cast<float>(line.sigma_m), true);
  }
  const Pose2D& here = map.nodes[node].pose;
  for (const int neighbour : grid.near(here, radius_m, turn_rad)) {
    if (neighbour == node || neighbour == left_out) continue;
    const Pose2D step = relative(map.nodes[neighbour].pose, here);
    const auto c = static_cast<float>(std::cos(step.heading_rad));
    const auto s = static_cast<float>(std::sin(step.heading_rad));
    const auto x = static_cast<float>(step.x_m), y = static_cast<float>(step.y_m);
    const auto moved = [&](const Eigen::Vector3d& p) {
      const Eigen::Vector3f q = p.cast<float>();
      return Eigen::Vector3f(x + c * q.x() - s * q.y(), y + s * q.x() + c * q.y(), q.z());
    };
    for (const PlaceLine& line : map.nodes[neighbour].view.lines) {
      const Eigen::Vector3f a = moved(line.a_m), b = moved(line.b_m);
      const auto sigma = static_cast<float>(line.sigma_m);
      if (!known.contain(a, b, sigma)) add(a, b, sigma, false);
    }
  }
  lines.pad();
  return lines;
}

}  // namespace vernier::localise::internal
