// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "localise/place.h"
#include "localise/topological_map.h"
#include "localise/verification/floor_plan_votes.h"

namespace vernier::localise::internal {

/// Finds poses anywhere on the floor that a map covers, at any heading, from vertical lines alone.
class FloorSearch {
 public:
  explicit FloorSearch(const TopologicalMap& map);

  /// The poses with most votes, best first, at most 40.
  std::vector<Pose2D> poses(std::span<const PlanUpright> query) const;

 private:
  std::vector<PlanUpright> uprights_;  // of all nodes, each once, in the world frame
  float left_m_ = 0, low_m_ = 0;
  std::vector<char> covered_;  // cells within reach of a node
  int columns_ = 0, rows_ = 0;
};

}  // namespace vernier::localise::internal
