// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/study/free_floor.h"
#include "sim/study/look_alike_poses.h"
#include "sim/study/wire_frame.h"
#include "sim/visibility.h"

namespace vernier::sim {
class QueryPlaces;
}

namespace vernier::sim::internal {

/// An answer so close to the truth is right.
inline constexpr double right_within_m = 1;

/// Poses that cannot be distinguished from a given one.
struct Aliases {
  /// Whether the view determines a pose up to finitely many others. It does not without two upright
  /// or level edges, with uprights at one place of the floor only, or with parallel level edges
  /// only. False too where there are too many level edges to try.
  bool determined = true;
  /// The given pose, then those with the same noise-free view, at any distance and heading; the
  /// search ends at 1000. Poses closer than 0.15 m and 0.1 rad are one.
  std::vector<localise::Pose2D> poses;
  std::vector<double> weights;  ///< one a pose, above 0
  /// Those more than 1 m from the given one.
  int elsewhere() const;
};

/// What the best guess can reach for one query.
struct QueryCeiling {
  /// Probability that the best guess is within 1 m; 0 where the poses are a continuum.
  double right = 0;
  /// Whether no pose of positive weight more than 1 m away looks the same.
  bool unaliased = false;
  bool operator==(const QueryCeiling&) const = default;
};

/// By query; nothing of those that are not computed yet.
using QueryCeilings = std::vector<std::optional<QueryCeiling>>;

/// The best guess from one noise-free look, by who knows the world and how likely each pose is
/// beforehand. Of poses that look the same each has the posterior w_i / sum w: they are rigid
/// motions of each other, which keep volumes. The best guess is the disc of 1 m on the floor with
/// the greatest sum.
QueryCeiling query_ceiling(const Aliases& aliases);

/// Finds all poses from which the world looks the same as from a given one: what limits the success
/// of any localiser of one look that goes by lines, computed without a localiser.
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

  /// With the density of the queries as weights; poses at which it is 0 are left out, but for the
  /// given one, which counts at least 1. Without places all poses are equally likely.
  Aliases aliases(const localise::Pose2D& pose, const QueryPlaces* places = nullptr) const;

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
