// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "localise/place.h"
#include "localise/topological_map.h"

namespace vernier::localise::internal {

/// Finds the nodes of a map near a position, however many there are.
class NodeGrid {
 public:
  explicit NodeGrid(const TopologicalMap& map);

  /// Nodes within `radius_m` (at most 2 m) whose headings differ by at most `turn_rad`, ascending.
  std::vector<int> near(const Pose2D& pose, double radius_m, double turn_rad) const;

  /// The node from which a view at `pose` is predicted best: near, and turned the same way (a turn
  /// of 1 rad counts as 0.5 m), other than `left_out`. -1 if none is within 2 m and 0.6 rad.
  int nearest(const Pose2D& pose, int left_out = -1) const;

 private:
  static constexpr double cell_m_ = 2;
  struct Cell {
    std::int64_t x = 0, y = 0;
  };
  static Cell cell(const Pose2D& pose);
  static std::uint64_t key(std::int64_t x, std::int64_t y);
  void visit(const Pose2D& pose, const std::function<void(int)>& node) const;

  const TopologicalMap& map_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace vernier::localise::internal
