// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

/// How many places look the same as one.
struct Aliases {
  int elsewhere = 0;  ///< poses more than 1 m away with the same noise-free view
  std::vector<localise::Pose2D> examples;  ///< a few of them
  /// What the best guess among indistinguishable places succeeds with.
  double ceiling() const { return 1.0 / (1 + elsewhere); }
};

/// Finds every pose from which the world looks as it does from another: the upper limit of what any
/// localiser can do there, written without use of one.
///
/// Noise-free and exhaustive: two upright edges of the view, far apart, are laid on every pair of
/// upright edges of the world at their distance (to 1 cm); a pose so found must put every other
/// edge of the view onto the world's wire frame (to 2 cm, 95 % of the image length), and the view
/// rendered from there must consist of the same edges (95 % again).
class AliasFinder {
 public:
  /// Keeps references to `visibility`; the rig is the true one.
  AliasFinder(const Visibility& visibility, Rig rig, NoiseFreeViewOptions options);

  Aliases aliases(const localise::Pose2D& pose) const;

 private:
  /// An upright edge: where it stands and from which height to which.
  struct Upright {
    Eigen::Vector2d at_m;
    double low_m, high_m;
  };
  /// An edge of a view in the robot's frame, with its length in the image.
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
  Eigen::Vector2d origin_m_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<int>> cells_;  // uprights by a grid on the floor
};

}  // namespace vernier::sim::internal
