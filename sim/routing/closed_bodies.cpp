// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/routing/closed_bodies.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "sim/visibility/box_tree.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/world.h"

namespace vernier::sim::internal {

ClosedBodies::ClosedBodies(const World& world) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const WorldSurface& surface : world.surfaces) {
    const PolygonPlane plane = polygon_plane(surface.polygon_m);
    if (plane.normal.isZero()) continue;
    faces_.push_back({plane.normal, plane.distance_m, &surface.polygon_m});
    Eigen::AlignedBox3d& box = boxes.emplace_back();
    for (const Eigen::Vector3d& p : surface.polygon_m) box.extend(p);
  }
  boxes_ = BoxTree(std::move(boxes));
}

/// Calls visit(distance, is_from_behind) for the surfaces that a ray meets.
template <class Visit>
void ClosedBodies::visit_along(const Eigen::Vector3d& at_m,
                               int axis,
                               double sign,
                               const Visit& visit) const {
  constexpr double parallel = 1e-6;  // to the ray, so that it does not cross
  Eigen::AlignedBox3d ray(at_m);
  (sign > 0 ? ray.max() : ray.min())[axis] = sign * std::numeric_limits<double>::infinity();
  const auto meets = [&](const Eigen::AlignedBox3d& box) { return ray.intersects(box); };
  boxes_.visit(meets, [&](int i) {
    const Face& face = faces_[static_cast<std::size_t>(i)];
    if (std::abs(face.normal[axis]) < parallel) return false;
    const double far_m = sign * (face.distance_m - face.normal.dot(at_m)) / face.normal[axis];
    if (far_m > 0 && inside_outline(at_m, *face.polygon_m, axis)) {
      visit(far_m, sign * face.normal[axis] > 0);
    }
    return false;  // and go on
  });
}

int ClosedBodies::winding_along(const Eigen::Vector3d& at_m, int axis, double sign) const {
  int winding = 0;
  visit_along(at_m, axis, sign,
              [&](double, bool is_from_behind) { winding += is_from_behind ? 1 : -1; });
  return winding;
}

/// Whether a surface faces down at the height of the floor, unlike that of a room.
bool ClosedBodies::has_bottom(const Eigen::Vector3d& at_m) const {
  constexpr double floor_m = 0.05;  // less than a slab is thick
  bool is_found = false;
  visit_along(at_m, 2, -1, [&](double far_m, bool is_from_behind) {
    is_found = is_found || (is_from_behind && std::abs(at_m.z() - far_m) < floor_m);
  });
  return is_found;
}

Enclosure ClosedBodies::enclosure(const Eigen::Vector3d& at_m) const {
  constexpr int least = 3;
  int above = 0, below = 0;
  for (const auto& [axis, sign] : {std::pair(0, 1.0), {0, -1.0}, {1, 1.0}, {1, -1.0}, {2, 1.0}}) {
    const int winding = winding_along(at_m, axis, sign);
    above += winding > 0;
    below += winding < 0;
  }
  if (below >= least && above == 0) return Enclosure::inward_shell;
  if (above < least || below > 0) return Enclosure::none;
  return has_bottom(at_m) ? Enclosure::body : Enclosure::outward_shell;
}

}  // namespace vernier::sim::internal
