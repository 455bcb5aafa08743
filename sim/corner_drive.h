// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

/// What a robot's rig sees of the world's corners along a drive.
struct CornerDrive {
  std::vector<Pose> T_world_left;                            ///< true poses of the left camera
  std::vector<std::vector<localise::StereoCorner>> moments;  ///< one per pose
};

/// Corners seen from each pose of a drive by the true rig, through the corners' error sources.
/// Their appearance is that of CornerAppearance with its default options: moments of a drive follow
/// each other closely, and it is the same in all. The same seed and trial give the same drive to
/// the bit. Throws Error as Sensor does.
CornerDrive drive_past_corners(const Visibility& visibility,
                               const Rig& true_rig,
                               const SourceSettings& sources,
                               const localise::CameraMount& mount,
                               std::span<const localise::Pose2D> poses,
                               std::uint64_t seed,
                               std::uint32_t trial);

}  // namespace vernier::sim
