// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/study/upright_edges.h"
#include "sim/visibility.h"
#include "sim/visibility/box_tree.h"

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
  /// Success rate of the best guess among indistinguishable poses.
  double ceiling() const { return determined ? 1.0 / (1 + elsewhere) : 0; }
};

/// Finds all poses from which the world looks the same as from a given one: the upper limit of any
/// localiser's success rate, computed without a localiser.
///
/// Noise-free and exhaustive. A view is the edges that the left camera sees, as lines in space. Two
/// of its upright edges are fitted to every pair of upright edges of the world at the same distance
/// (to 1 cm); where it has no two, an upright and a level edge to every upright with such a level
/// edge beside it. Of all such pairs of the view one far apart and rare in the world is taken. A
/// resulting pose must map every other edge of the view onto the world's wire frame (to 2 cm, 95 %
/// of the image length), and the view from there must consist of the same edges (95 % again).
class AliasFinder {
 public:
  /// Keeps a reference to `visibility`; `rig` is the true rig.
  AliasFinder(const Visibility& visibility, Rig rig, NoiseFreeViewOptions options);

  Aliases aliases(const localise::Pose2D& pose) const;

 private:
  /// An edge of a view in the robot frame, with its length in the image.
  struct ViewEdge {
    Eigen::Vector3d a_m, b_m;
    double length_px;
  };

  /// By descending length.
  std::vector<ViewEdge> view_from(const localise::Pose2D& pose) const;
  /// Poses that may look the same; std::nullopt if the view does not determine any.
  std::optional<std::vector<localise::Pose2D>> hypotheses(const std::vector<ViewEdge>& view) const;
  void fit_uprights(const Upright& p, const Upright& q, std::vector<localise::Pose2D>& poses) const;
  void fit_level(const Upright& p,
                 const ViewEdge& level,
                 std::vector<localise::Pose2D>& poses) const;
  bool on_wire_frame(const std::vector<ViewEdge>& view, const localise::Pose2D& pose) const;
  bool on_a_segment(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const;

  const Visibility& visibility_;
  Rig rig_;
  NoiseFreeViewOptions options_;
  UprightEdges uprights_;
  BoxTree segments_;
};

}  // namespace vernier::sim::internal
