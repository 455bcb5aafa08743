// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/study/upright_edges.h"
#include "sim/visibility.h"
#include "sim/visibility/box_tree.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// An edge as a robot sees it, without noise: in the robot's frame, with its length in the left
/// image.
struct ViewEdge {
  Eigen::Vector3d a_m, b_m;
  double length_px = 0;
  bool upright = false, level = false;
};

/// What both cameras of a robot at `pose` see, as the sources of error get it, by descending length
/// in the left image.
std::vector<ViewEdge> edges_in_view(const Visibility& visibility,
                                    const Rig& rig,
                                    const NoiseFreeViewOptions& options,
                                    const localise::Pose2D& pose);

/// The upright that an edge is; nothing for other edges.
std::optional<Upright> upright_of(const ViewEdge& edge);

/// Whether a point lies on a segment, to UprightEdges::tolerance_m.
bool lies_on(const Eigen::Vector3d& x, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// A planar motion of points in space.
class FloorMotion {
 public:
  explicit FloorMotion(const localise::Pose2D& pose);
  Eigen::Vector3d operator()(const Eigen::Vector3d& x) const {
    return {x_ + c_ * x.x() - s_ * x.y(), y_ + s_ * x.x() + c_ * x.y(), x.z()};
  }

 private:
  double x_, y_, c_, s_;
};

/// The edges of a world, hidden or not, by place. Immutable.
class WireFrame {
 public:
  /// Keeps a reference to `world`.
  explicit WireFrame(const World& world);

  const UprightEdges& uprights() const { return uprights_; }

  /// Whether one edge has both points on it, to UprightEdges::tolerance_m.
  bool has(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const;

  /// Calls visit(segment) for the level edges whose boxes meet `box`, until it returns true.
  template <class Visit>
  void visit_level(const Eigen::AlignedBox3d& box, Visit visit) const {
    level_.visit([&](const Eigen::AlignedBox3d& other) { return box.intersects(other); },
                 [&](int i) { return visit(world_.segments[level_number_[i]]); });
  }

 private:
  const World& world_;
  UprightEdges uprights_;
  BoxTree segments_, level_;       // the boxes of segments_ are wider by the tolerance
  std::vector<int> level_number_;  // index into World::segments
};

}  // namespace vernier::sim::internal
