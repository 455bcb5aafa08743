// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace vernier::sim::internal {

/// What a world looks like, which no world file says.
struct SurfaceAppearanceOptions {
  std::uint64_t seed = 1;             ///< of reflectances, textures and painted lines
  double least_reflectance = 0.25;    ///< mean of a surface: uniform from this …
  double largest_reflectance = 0.85;  ///< … to this
  double texture_contrast =
      0.02;                      ///< RMS of a surface's reflectance, relative to its mean; 0: plain
  double texture_scale_m = 0.1;  ///< longest wavelength of the texture
  double least_step = 0.1;    ///< relative change of reflectance by what is painted, from this …
  double largest_step = 0.5;  ///< … to this, below 1
  double line_width_m = 0.012;  ///< of lines that border nothing
};

/// Throws Error for options out of range.
void check_appearance(const SurfaceAppearanceOptions& options);

}  // namespace vernier::sim::internal
