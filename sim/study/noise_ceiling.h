// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/study/free_floor.h"
#include "sim/study/view_likelihood.h"
#include "sim/study/wire_frame.h"
#include "sim/visibility.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// The outcome of one noisy look.
struct NoisyLook {
  double here = 0;         ///< log-likelihood of the best pose within 1 m of the truth
  double elsewhere = 0;    ///< of the best rival, more than 1 m away; -infinity if there is none
  int rivals = 0;          ///< that were found
  bool determined = true;  ///< whether rivals can be found (Aliases::determined)
  localise::Pose2D best_rival;
  bool right() const { return determined && here > elsewhere; }
};

/// A ceiling that knows the noise: whether one noisy look tells its place from all others that look
/// somewhat alike, by the likelihood under the known sources and the world's true edges
/// (view_likelihood.h). A localiser of one look, even with a perfect map, is right no more often in
/// the mean; one with several looks may be.
///
/// Rivals are the poses of look_alike_poses.h, for pairs of edges with 30 % of the image length,
/// where the robot can stand and at least half of the view lies on the wire frame. The likelihood
/// of the best ten and that of the truth are then improved by a search around each (5 cm and 1°,
/// halved four times), the truth's as the rivals', so that neither has an advantage.
///
/// Approximate from both sides. Too high: rivals that share no pair of edges with the view to 1 cm
/// are not found; the true rig is known. Too low: the likelihood assigns edges one by one.
class NoiseCeiling {
 public:
  /// Keeps a reference to `visibility`; `rig` is the true rig.
  NoiseCeiling(const Visibility& visibility,
               const Rig& rig,
               NoiseFreeViewOptions options,
               const SourceSettings& sources);

  NoisyLook look_from(const localise::Pose2D& pose, const SensingDraw& draw) const;

 private:
  struct Scored {
    localise::Pose2D pose;
    double score;
  };
  double score(const std::vector<stereo::StereoSegment>& sensed,
               const localise::Pose2D& pose) const;
  Scored improved(const std::vector<stereo::StereoSegment>& sensed, Scored start) const;
  /// std::nullopt if the view fits a continuum of poses.
  std::optional<std::vector<localise::Pose2D>> rivals(const localise::Pose2D& pose) const;

  const Visibility& visibility_;
  Rig rig_;
  NoiseFreeViewOptions options_;
  Sensor sensor_;
  ViewLikelihood likelihood_;
  WireFrame frame_;
  Standing standing_;
};

}  // namespace vernier::sim::internal
