// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sim/visibility/box_tree.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// Surfaces of a world by place: which of them a segment borders, or lies on.
class Backing {
 public:
  /// Keeps a reference to `world`, which must outlive this.
  explicit Backing(const World& world);

  /// Whether at least half of a segment runs along the border of a surface, to 1 mm.
  bool borders(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const;

  /// Normal of the nearest surface that has all of these points within `reach_m` of itself, at the
  /// same distance to 2 mm.
  std::optional<Eigen::Vector3d> behind(const std::vector<Eigen::Vector3d>& points_m,
                                        double reach_m) const;

 private:
  const World& world_;
  std::vector<PolygonPlane> planes_;
  BoxTree tree_;
};

}  // namespace vernier::sim::internal
