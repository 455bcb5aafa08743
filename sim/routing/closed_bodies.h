// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/visibility/box_tree.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// What the surfaces around a point are the sides of.
enum class Enclosure {
  none,           ///< of no single thing: walls with two sides, or nothing on most sides
  inward_shell,   ///< of single sheets that face the point: a room, or a block turned inside out
  outward_shell,  ///< of single sheets that face away, without a bottom: a room or a block
  body            ///< of a closed body on the floor, such as a building that is a solid block
};

/// The surfaces of a world as the sides of bodies that may overlap.
class ClosedBodies {
 public:
  /// Keeps references to the surfaces of `world`.
  explicit ClosedBodies(const World& world);

  /// By the winding number of the surfaces about a point: of those that a ray meets, those seen
  /// from behind, as from within a body, less those seen from the front. It is above 0 within
  /// bodies, overlapping ones too, 0 between walls with two sides, and below 0 where faces look
  /// inwards. Along x and y in both directions and upwards, three rays at least have to agree and
  /// none to object, because the ceiling of a storey may be missing.
  Enclosure enclosure(const Eigen::Vector3d& at_m) const;

 private:
  struct Face {
    Eigen::Vector3d normal;
    double distance_m;
    const std::vector<Eigen::Vector3d>* polygon_m;
  };
  int winding_along(const Eigen::Vector3d& at_m, int axis, double sign) const;
  bool has_bottom(const Eigen::Vector3d& at_m) const;
  template <class Visit>
  void visit_along(const Eigen::Vector3d& at_m, int axis, double sign, const Visit& visit) const;

  std::vector<Face> faces_;
  BoxTree boxes_;  // of the faces
};

}  // namespace vernier::sim::internal
