// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "calib/camera.h"
#include "stereo/grey_levels.h"

namespace vernier::sim::internal {

/// How a camera turns radiance into grey levels.
struct SensorOptions {
  double point_spread_px = 0.6;  ///< standard deviation of a Gaussian, besides the pixel's own area
  double vignetting = 0.3;       ///< 0: none, 1: the full cos⁴ of an angle to the axis
  double exposure = 0;           ///< share of the full well per radiance of 1; 0: automatic
  double full_well_e = 10'000;   ///< electrons at grey level 255
  double read_noise_e = 8;       ///< standard deviation, electrons
  double gamma = 1;              ///< grey = 255 (electrons / full well)^(1 / gamma)
  bool noise = true;             ///< photon and read noise …
  bool whole_levels = true;      ///< … and rounding to whole grey levels
};

/// Throws Error for options out of range.
void check_sensor(const SensorOptions& options);

/// Which draws an image has: counter (image, pixel, eye), source `sensor_noise`.
struct SensorDraws {
  std::uint64_t seed = 1;
  std::uint32_t image = 0;  ///< number of the pair
  std::uint32_t eye = 0;    ///< 0 left, 1 right
};

/// Radiance behind the lens: a separable Gaussian, the border replicated, and vignetting,
///
///     blurred(u, v) (1 - v (1 - cos⁴ θ)),   θ the angle of the pixel's ray to the optical axis
stereo::GreyLevels through_lens(const stereo::GreyLevels& radiance,
                                const Camera& camera,
                                const SensorOptions& options);

/// The exposure at which the brightest twentieth of an image is at four fifths of the full well.
double automatic_exposure(const stereo::GreyLevels& behind_lens);

/// Grey levels of what is behind the lens (EMVA Standard 1288, release 4.0, without dark current):
///
///     e = Poisson(full well · exposure · radiance) + N(0, read noise²),   clipped to [0, full
///     well]
///
/// Without noise e is its mean. `exposure` in the options must be set.
stereo::GreyLevels sensed(const stereo::GreyLevels& behind_lens,
                          const SensorOptions& options,
                          const SensorDraws& draws = {});

}  // namespace vernier::sim::internal
