// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

/// What a robot's rig sees of the world's corners along a drive.
struct CornerDrive {
  std::vector<Pose> T_world_left;                            ///< true poses of the left camera
  std::vector<std::vector<localise::StereoCorner>> moments;  ///< one per pose
};

/// The appearance of a corner: a random direction that all instances of a template share, so that
/// repeated furniture looks alike.
class CornerAppearance {
 public:
  explicit CornerAppearance(const World& world);
  const Eigen::VectorXf& of(std::uint32_t corner) const { return descriptors_[corner]; }

 private:
  std::vector<Eigen::VectorXf> descriptors_;
};

/// The corners that a look of the sensor gave, as an estimator gets them. Their covariance is that
/// of the pixel noise, at least (0.02 px)².
std::vector<localise::StereoCorner> stereo_corners(const StereoObservation& observation,
                                                   const CornerAppearance& appearance,
                                                   const SourceSettings& sources);

/// Corners seen from each pose of a drive by the true rig, through the corners' error sources. The
/// same seed and trial give the same drive to the bit. Throws Error as Sensor does.
CornerDrive drive_past_corners(const Visibility& visibility,
                               const Rig& true_rig,
                               const SourceSettings& sources,
                               const localise::CameraMount& mount,
                               std::span<const localise::Pose2D> poses,
                               std::uint64_t seed,
                               std::uint32_t trial);

}  // namespace vernier::sim
