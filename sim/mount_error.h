// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"

namespace vernier::sim {

/// How the left camera truly stands on the robot, which the estimator does not know.
struct TrueMount {
  localise::CameraMount mount;
  double roll_rad = 0;  ///< about the optical axis; positive: clockwise as seen from behind
};

/// The told mount with the normal errors of `mount_height_m`, `mount_pitch_deg` and
/// `mount_roll_deg`, one draw a trial. The camera stays 1 cm above the floor at least, and its
/// pitch within ± 89°. With all three at 0 it is the told mount to the bit.
TrueMount draw_mount(const localise::CameraMount& told,
                     const SourceSettings& settings,
                     std::uint64_t seed,
                     std::uint32_t trial);

/// How a rig on that mount looks, with the other options as they are by default.
NoiseFreeViewOptions look_from(const TrueMount& stands);

}  // namespace vernier::sim
