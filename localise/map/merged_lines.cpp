// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/map/merged_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "localise/place.h"

namespace vernier::localise::internal {

namespace {

struct Direction {
  Eigen::Vector3f unit;
  float length_m;
};

Direction direction(const SpaceLines& lines, std::size_t i) {
  const Eigen::Vector3f along = lines.b_m(i) - lines.a_m(i);
  const float length = along.norm();
  return {along / std::max(length, 1e-6f), length};
}

}  // namespace

SpaceLines merged_lines(const TopologicalMap& map, const NodeGrid& grid, int node) {
  constexpr double radius_m = 1.1, turn_rad = 1.05;
  // A line is the same as one that is known if it is parallel to 10 degrees, lies along it and no
  // further aside than both are uncertain.
  constexpr float least_cosine = 0.985f, excess_share = 0.15f, excess_m = 0.1f, aside_m = 0.05f;
  SpaceLines lines;
  for (const PlaceLine& line : map.nodes[node].view.lines) {
    lines.add(line.a_m.cast<float>(), line.b_m.cast<float>(), static_cast<float>(line.sigma_m),
              true);
  }
  std::vector<Direction> directions;
  for (std::size_t i = 0; i < lines.size; ++i) directions.push_back(direction(lines, i));
  const Pose2D& here = map.nodes[node].pose;
  for (const int neighbour : grid.near(here, radius_m, turn_rad)) {
    if (neighbour == node) continue;
    const Pose2D step = relative(map.nodes[neighbour].pose, here);
    const auto c = static_cast<float>(std::cos(step.heading_rad));
    const auto s = static_cast<float>(std::sin(step.heading_rad));
    const auto x = static_cast<float>(step.x_m), y = static_cast<float>(step.y_m);
    const auto moved = [&](const Eigen::Vector3d& p) {
      const Eigen::Vector3f q = p.cast<float>();
      return Eigen::Vector3f(x + c * q.x() - s * q.y(), y + s * q.x() + c * q.y(), q.z());
    };
    for (const PlaceLine& line : map.nodes[neighbour].view.lines) {
      const Eigen::Vector3f a = moved(line.a_m), b = moved(line.b_m), middle = 0.5f * (a + b);
      const float length = (b - a).norm();
      const Eigen::Vector3f along = (b - a) / std::max(length, 1e-6f);
      const auto sigma = static_cast<float>(line.sigma_m);
      const float excess = excess_share * length + excess_m;
      bool is_known = false;
      for (std::size_t i = 0; i < lines.size && !is_known; ++i) {
        const Direction& known = directions[i];
        if (std::abs(known.unit.dot(along)) < least_cosine) continue;
        const Eigen::Vector3f r = middle - lines.a_m(i);
        const float at = r.dot(known.unit);
        if (at - 0.5f * length < -excess || at + 0.5f * length > known.length_m + excess) continue;
        const float aside = aside_m + 0.25f * (lines.sigma_m[i] + sigma);
        is_known = (r - at * known.unit).squaredNorm() < aside * aside;
      }
      if (is_known) continue;
      lines.add(a, b, sigma, false);
      directions.push_back({along, length});
    }
  }
  lines.pad();
  return lines;
}

}  // namespace vernier::localise::internal
