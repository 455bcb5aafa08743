// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/experiment.h"
#include "sim/noise_free_view.h"
#include "sim/study/free_floor.h"
#include "sim/study/look_alike_poses.h"
#include "sim/study/wire_frame.h"
#include "sim/visibility.h"

namespace vernier::sim::internal {

/// Poses that cannot be distinguished from a given one.
struct Aliases {
  /// Whether the view determines a pose up to finitely many others. It does not without two upright
  /// or level edges, with uprights at one place of the floor only, or with parallel level edges
  /// only.
  bool determined = true;
  /// The given pose, then those with the same noise-free view, at any distance and heading; the
  /// search ends at 1000.
  std::vector<localise::Pose2D> poses;
  /// Those more than 1 m from the given one.
  int elsewhere() const;
};

/// What the best guess can reach for one query.
struct QueryCeiling {
  /// Probability that the best guess is within 1 m; 0 where the poses are a continuum.
  double right = 0;
  /// Whether no pose more than 1 m away, at which the protocol asks, looks the same.
  bool unaliased = false;
  bool operator==(const QueryCeiling&) const = default;
};

/// By query; nothing of those that are not computed yet.
using QueryCeilings = std::vector<std::optional<QueryCeiling>>;

/// The best guess of who knows the world, the protocol and a noise-free view. Of poses that look
/// the same each has the posterior density w_i / sum w, w = QueryPlaces::density: look-alikes are
/// rigid motions of each other, which keep volumes. The best guess is the disc of 1 m on the floor
/// with the greatest sum; no localiser answers better in the mean over the protocol's queries.
QueryCeiling query_ceiling(const Aliases& aliases, const QueryPlaces& places);

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
