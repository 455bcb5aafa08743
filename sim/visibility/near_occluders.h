// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "sim/visibility/box_tree.h"
#include "sim/visibility/convex_pieces.h"
#include "sim/visibility/view_frustum.h"

namespace vernier::sim::internal {

/// The surfaces of a world that are large enough to hide much of a view from far.
class LargeSurfaces {
 public:
  explicit LargeSurfaces(const ConvexSurfaces& surfaces);

  const BoxTree& tree() const { return tree_; }
  /// Index among the world's convex surfaces of the i-th box of the tree, and its area.
  int piece(int i) const { return pieces_[i]; }
  double area_m2(int i) const { return areas_m2_[i]; }

 private:
  std::vector<int> pieces_;
  std::vector<double> areas_m2_;
  BoxTree tree_;
};

/// The few large surfaces nearest to an eye, with which boxes are found that one of them
/// hides whole. What hides in the shadow of a surface neither is seen nor hides anything that is
/// not hidden already, so leaving it out changes nothing, and the cost of a view depends on what is
/// seen and not on what exists behind (idea: Coorg and Teller, "Real-time occlusion culling for
/// models with large occluders", 1997).
class NearOccluders {
 public:
  /// Searches from the eye on until what is left is hidden or small. World frame.
  void choose(const ConvexSurfaces& surfaces,
              const LargeSurfaces& large,
              const Eigen::Vector3d& eye,
              const ViewVolume& volume,
              double gap_m);

  /// Whether one of the surfaces hides all of a box, with 1 µm to spare.
  bool hide(const Eigen::AlignedBox3d& box) const;

 private:
  struct Side {
    Eigen::Vector3d inward, absolute;
    double offset;  ///< inward·x > offset inside
  };

  void add(const ConvexSurfaces& surfaces, int piece, const Eigen::Vector3d& eye, double gap_m);

  std::vector<Side> sides_;       ///< of one surface after the other
  std::vector<int> side_counts_;  ///< one per surface
};

}  // namespace vernier::sim::internal
