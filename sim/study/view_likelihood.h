// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calib/rig.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// Likelihood of sensed edges, given the noise-free view from a pose, under the known sources.
///
/// Each sensed edge is explained by the visible edge that makes it most likely. Its four ends (two
/// eyes) are d_k across the image of that edge,
///
///     d_k = s + n_k,   |s| ~ U[l/2, 3l/2],   n_k ~ N(0, g²)
///
/// with the lateral shift s common to all ends and its sign common to the edges of an object, as
/// the source draws it; both signs are summed over. With probability psi_s the right eye's ends are
/// those of a wrong partner and say nothing. Along the edge an end is anywhere on its visible part.
/// A visible edge that no sensed one has as its partner was lost, which only edges near the
/// epipolar line or of less than two detectable pieces may be.
///
/// What it knows that no localiser does: the true rig, so that calibration errors do not exist
/// here, and the true edges of the world. What it leaves out: joint assignments of edges (each has
/// its own best one), and corners.
class ViewLikelihood {
 public:
  /// Throws Error for lateral shifts that are independent between the eyes.
  ViewLikelihood(Rig rig, const SourceSettings& sources, double min_length_px = 10);

  /// In nats, up to a constant of the sensed edges.
  double log_likelihood(const std::vector<stereo::StereoSegment>& sensed,
                        const NoiseFreeView& view) const;

 private:
  struct Seen {
    stereo::ImageSegment image[2];
    double side;  ///< +1 if the left normal points away from the object's centre
    int object;
    double right_by_left;  ///< pixels of a common shift (sim/sources/common_shift.h)
    bool certain;          ///< at least one piece of it is sensed
  };
  struct Fit {
    double outward, inward;  ///< log-likelihoods of both signs of the shift
  };
  Seen seen(const VisibleEdge& edge) const;
  Fit fit(const stereo::StereoSegment& sensed, const Seen& edge) const;
  double shift_density(double mean_px, double information) const;

  Rig rig_;
  stereo::Rectification rectification_;
  SourceSettings sources_;
  double min_length_px_, sigma_px_;
};

}  // namespace vernier::sim::internal
