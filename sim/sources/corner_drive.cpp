// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/corner_drive.h"

#include <cstdint>
#include <vector>

#include "calib/rig.h"
#include "localise/place.h"
#include "sim/corner_appearance.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/sources/sensed_check.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

using localise::Pose2D;

CornerDrive drive_past_corners(const Visibility& visibility,
                               const Rig& true_rig,
                               const SourceSettings& sources,
                               const localise::CameraMount& mount,
                               std::span<const Pose2D> poses,
                               std::uint64_t seed,
                               std::uint32_t trial) {
  SourceSettings of_corners = sources;
  of_corners.command.clear();  // a program is asked about edges
  const Sensor sensor(true_rig, of_corners);
  const CornerAppearance appearance(visibility.world());
  NoiseFreeViewOptions looking;
  looking.mount = mount;
  looking.with_corners = true;
  CornerDrive drive;
  for (const Pose2D& pose : poses) {
    const auto moment = static_cast<std::uint32_t>(drive.moments.size());
    NoiseFreeView seen = look(visibility, true_rig, pose, looking);
    seen.edges.clear();  // only corners are sensed
    const SensingDraw draw{.seed = seed, .trial = trial, .frame = moment};
    drive.moments.push_back(stereo_corners(internal::require_sensed(sensor.sense(seen, draw)),
                                           appearance, sources, eye_of(pose, mount), draw));
    drive.T_world_left.push_back(T_left_world(pose, mount).inverse());
  }
  return drive;
}

}  // namespace vernier::sim
