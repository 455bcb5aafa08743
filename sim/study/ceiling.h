// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/study/floor_grid.h"
#include "sim/visibility.h"
#include "sim/visibility/box_tree.h"

namespace vernier::sim::internal {

/// Poses that cannot be distinguished from a given one.
struct Aliases {
  /// Number of poses more than 1 m away with the same noise-free view; the search ends at 1000.
  int elsewhere = 0;
  std::vector<localise::Pose2D> examples;  ///< some of them
  /// Success rate of the best guess among indistinguishable poses.
  double ceiling() const { return 1.0 / (1 + elsewhere); }
};

/// Finds all poses from which the world looks the same as from a given one: the upper limit of any
/// localiser's success rate, computed without a localiser.
///
/// Noise-free and exhaustive: two distant vertical edges of the view are fitted to every pair of
/// vertical edges of the world at the same distance (to 1 cm). A resulting pose must map every
/// other edge of the view onto the world's wire frame (to 2 cm, 95 % of the image length), and the
/// view rendered from there must consist of the same edges (95 % again).
class AliasFinder {
 public:
  /// Keeps a reference to `visibility`; `rig` is the true rig.
  AliasFinder(const Visibility& visibility, Rig rig, NoiseFreeViewOptions options);

  Aliases aliases(const localise::Pose2D& pose) const;

 private:
  /// A vertical edge: its position on the floor and its range of heights.
  struct Upright {
    Eigen::Vector2d at_m;
    double low_m, high_m;
  };
  /// An edge of a view in the robot frame, with its length in the image.
  struct ViewEdge {
    Eigen::Vector3d a_m, b_m;
    double length_px;
  };

  std::vector<ViewEdge> view_from(const localise::Pose2D& pose) const;
  std::vector<localise::Pose2D> hypotheses(const std::vector<ViewEdge>& view) const;
  bool has_upright(const Eigen::Vector2d& at_m, double low_m, double high_m) const;
  bool on_wire_frame(const std::vector<ViewEdge>& view, const localise::Pose2D& pose) const;

  const Visibility& visibility_;
  Rig rig_;
  NoiseFreeViewOptions options_;
  std::vector<Upright> uprights_;
  FloorGrid close_{0.1}, wide_{1};  // numbers of uprights, for two ranges of distance
  BoxTree segments_;
};

}  // namespace vernier::sim::internal
