// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/study/free_floor.h"
#include "sim/study/look_alike_poses.h"
#include "sim/study/wire_frame.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

/// Poses that cannot be distinguished from a given one.
struct Aliases {
  /// Number of poses more than 1 m away with the same noise-free view; the search ends at 1000.
  int elsewhere = 0;
  /// Whether the view determines a pose up to finitely many others. It does not without an upright
  /// edge, or with uprights at one place of the floor only and no level edge.
  bool determined = true;
  std::vector<localise::Pose2D> examples;  ///< some of them
  bool unique() const { return determined && elsewhere == 0; }
  /// Success rate of the best guess among indistinguishable poses; 0 among a continuum of them.
  double ceiling() const { return determined ? 1.0 / (1 + elsewhere) : 0; }
};

/// Finds all poses from which the world looks the same as from a given one: the upper limit of any
/// localiser's success rate, computed without a localiser.
///
/// Noise-free. A view is the edges that both cameras see, as lines in space: what a localiser gets,
/// but for its corners. Of the poses that fit two edges of it to the world (look_alike_poses.h),
/// those are taken that map the other edges onto the world's wire frame (to 2 cm, 95 % of the image
/// length), where the robot can stand, and from where the view consists of the same edges (95 %
/// again).
class AliasFinder {
 public:
  /// Keeps a reference to `visibility`; `rig` is the true rig.
  AliasFinder(const Visibility& visibility, Rig rig, NoiseFreeViewOptions options);

  Aliases aliases(const localise::Pose2D& pose) const;

 private:
  struct View {
    explicit View(std::vector<ViewEdge> all);
    std::vector<ViewEdge> edges;
    /// 64 of more edges, of all lengths: a pose that leaves a quarter unexplained is not tried
    /// further.
    std::vector<ViewEdge> sample;
  };
  bool on_wire_frame(const View& view, const localise::Pose2D& pose) const;
  bool looks_like(const std::vector<ViewEdge>& view, const localise::Pose2D& pose) const;

  const Visibility& visibility_;
  Rig rig_;
  NoiseFreeViewOptions options_;
  WireFrame frame_;
  Standing standing_;
};

}  // namespace vernier::sim::internal
