// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

/// The surfaces of a world as seen from a point: from the front, or from behind as the outside of a
/// closed body is seen from within it.
class ClosedBodies {
 public:
  explicit ClosedBodies(const World& world);

  /// Whether a point lies inside a closed body, such as a building that is a solid block: along x
  /// and y in both directions and upwards the nearest surfaces are seen from behind, three of them
  /// at least. Surfaces that coincide back to back, where two bodies touch, are looked through.
  bool contain(const Eigen::Vector3d& at_m) const;

 private:
  struct Face {
    Eigen::Vector3d normal, low_m, high_m;
    double distance_m;
    const std::vector<Eigen::Vector3d>* polygon_m;
  };
  /// 1 for a surface seen from behind, -1 from the front, 0 for none.
  int seen_along(const Eigen::Vector3d& at_m, int axis, double sign) const;

  std::vector<Face> faces_;
};

}  // namespace vernier::sim::internal
