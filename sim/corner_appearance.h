// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "localise/place.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/world.h"

namespace vernier::sim {

/// How the appearance of a simulated corner changes from one sighting to another.
struct AppearanceOptions {
  double view_change = 0;  ///< v below: with the direction from which it is seen; 0 to 100
  double noise = 0;        ///< n below: of every sighting alone; 0 to 100
};

/// Throws Error naming the option for a value out of range.
void check(const AppearanceOptions& options, const std::string& place);

/// The appearance of corners: with α the bearing of the eye from the corner in the frame of its
/// template,
///
///     d(α) = |b + v (c cos α + s sin α)|,   seen: |d(α) + n ε|,   ε ~ N(0, I / 32)
///
/// with |x| for x of unit length, and b, c and s random directions in 32 dimensions, keyed by the
/// template and the number of the corner in it. All instances of a template share them, so that
/// repeated furniture looks alike, from the same side; loose corners have their own. Two sightings
/// from bearings Δ apart have, in the mean and about, the similarity
/// (1 + v² cos Δ) / ((1 + v²) (1 + n²)). The form and its numbers are assumptions of ours.
class CornerAppearance {
 public:
  explicit CornerAppearance(const World& world, const AppearanceOptions& options = {});

  /// b of a corner, by its index in the world.
  Eigen::VectorXf of(std::uint32_t corner) const;
  /// What a sighting of it from `eye_m` (world frame) looks like.
  Eigen::VectorXf seen(std::uint32_t corner,
                       const Eigen::Vector3d& eye_m,
                       const SensingDraw& draw) const;

 private:
  struct Key {
    std::uint32_t of_template = 0, index = 0;
    double yaw_rad = 0;
    Eigen::Vector2d at_m;
  };
  AppearanceOptions options_;
  std::vector<Key> keys_;
};

/// The corners that a look of the sensor gave, as an estimator gets them. Their covariance is that
/// of the pixel noise, at least (0.02 px)².
std::vector<localise::StereoCorner> stereo_corners(const StereoObservation& observation,
                                                   const CornerAppearance& appearance,
                                                   const SourceSettings& sources,
                                                   const Eigen::Vector3d& eye_m,
                                                   const SensingDraw& draw);

/// Where the left camera of a robot stands, in the world frame.
Eigen::Vector3d eye_of(const localise::Pose2D& pose, const localise::CameraMount& mount);

}  // namespace vernier::sim
