// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// What stereo reconstructs of one raw pair with a rig that is told wrong, and what the simulator
// says of the same places with the same rig.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "stereo/grey_levels.h"
#include "stereo/segment.h"

namespace vernier::bench {

/// A pair of images as taken.
struct RawPair {
  stereo::GreyLevels left, right;
  stereo::DisparityRange range;  ///< searched with the given rig
};

/// A segment in space, in the left camera's frame (metres), and in the raw left image.
struct PlacedLine {
  stereo::ImageSegment left_px;
  Eigen::Vector3d a_m, b_m;
};

/// `rig` with the lens model opencv4 (no distortion where it had none), and the covariance of
/// another one in its units: pixels by the ratio of focal lengths, translations by that of the
/// baselines, angles and distortions as they are. Throws Error if the other's parameters are not
/// those of a pair of opencv4.
RigEstimate with_covariance_of(const Rig& rig, const RigEstimate& calibrated);

/// Rectifies with `told`, matches edges and places segments, as `vernier stereo` does.
std::vector<PlacedLine> reconstructed(const Rig& told,
                                      const RawPair& pair,
                                      const stereo::DisparityRange& range);

/// The range in which `told` has the disparities of lines seen by the true rig, with 8 px to spare,
/// and what is searched with the true one.
stereo::DisparityRange range_with(const Rig& told,
                                  const Rig& true_rig,
                                  const std::vector<PlacedLine>& lines,
                                  const stereo::DisparityRange& range);

/// The line that looks like another one in the raw left image: nearly parallel, near, overlapping.
const PlacedLine* like(const std::vector<PlacedLine>& lines,
                       const stereo::ImageSegment& left_px,
                       double most_off_px = 2);

/// The point of a line's carrier that is nearest to a ray from the camera; nothing if it is not in
/// front, or far beyond the line's ends.
std::optional<Eigen::Vector3d> on_ray(const PlacedLine& line, const Eigen::Vector3d& ray);

/// Lines as the simulator's sensor sees them (sim/sense.h) with end-point noise of `sigma_px` and
/// no other source, and its estimator (stereo/reconstruction/triangulate.h) places them with told
/// rigs. One look is one (seed, trial, frame).
class SimulatedPair {
 public:
  SimulatedPair(const Rig& true_rig,
                const std::vector<PlacedLine>& lines,
                double sigma_px,
                std::uint32_t trial,
                std::uint32_t frame);
  /// One for each line: nothing where the estimator calls it unreliable.
  std::vector<std::optional<PlacedLine>> placed_with(const Rig& told) const;

 private:
  std::vector<std::optional<stereo::StereoSegment>> sensed_;
};

/// Whether the cameras of a drawn rig are still side by side.
bool is_physical(const Rig& drawn, const Rig& true_rig);

}  // namespace vernier::bench
