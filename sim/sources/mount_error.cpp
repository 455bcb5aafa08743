// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/mount_error.h"

#include <algorithm>
#include <numbers>

#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"

namespace vernier::sim {

using namespace vernier::internal;

TrueMount draw_mount(const localise::CameraMount& told,
                     const SourceSettings& settings,
                     std::uint64_t seed,
                     std::uint32_t trial) {
  constexpr double degree = std::numbers::pi / 180, lowest_m = 0.01, steepest_rad = 89 * degree;
  TrueMount stands{told, 0};
  RandomStream draws(
      {.seed = seed, .trial = trial, .source = static_cast<std::uint32_t>(DrawSource::mount)});
  const double height = draws.normal(), pitch = draws.normal(), roll = draws.normal();
  if (settings.mount_height_m > 0) {
    stands.mount.height_m = std::max(lowest_m, told.height_m + settings.mount_height_m * height);
  }
  if (settings.mount_pitch_deg > 0) {
    stands.mount.pitch_rad = std::clamp(told.pitch_rad + settings.mount_pitch_deg * degree * pitch,
                                        -steepest_rad, steepest_rad);
  }
  stands.roll_rad = settings.mount_roll_deg * degree * roll;
  return stands;
}

NoiseFreeViewOptions look_from(const TrueMount& stands) {
  NoiseFreeViewOptions options;
  options.mount = stands.mount;
  options.roll_rad = stands.roll_rad;
  return options;
}

}  // namespace vernier::sim
