// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "calib/camera.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim::internal {

/// A set is used for poses within this distance and angle of its reference.
inline constexpr double set_reach_m = 1, set_reach_rad = 0.7853981633974483;

/// The set whose reference is nearest to a pose, by the squares of distance and angle over the
/// reaches; null if none is within both.
const ViewSet* nearest_set(const std::vector<ViewSet>& sets, const localise::Pose2D& pose);

/// Sets of the segments that a camera sees with exact visibility, at least `min_length_px` of one,
/// from each pose.
std::vector<ViewSet> view_sets(const Visibility& visibility,
                               const Camera& camera,
                               const localise::CameraMount& mount,
                               const std::vector<localise::Pose2D>& poses,
                               double min_length_px = 10);

/// How far edges by sets agree with exact ones, over some poses, by their length in the left image.
struct SetAgreement {
  double precision = 0;    ///< of the length by sets, what is seen
  double recall = 0;       ///< of the length that is seen, what the sets have
  double without_set = 0;  ///< share of poses that no set reaches
};
SetAgreement set_agreement(const World& world,
                           const Camera& camera,
                           const localise::CameraMount& mount,
                           const std::vector<localise::Pose2D>& poses);

}  // namespace vernier::sim::internal
