// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/world.h"

namespace vernier::sim::internal {

struct LightingOptions {
  double ambient =
      0.35;  ///< irradiance from everywhere, that of one lamp straight below it being 1
  double lamp_reach_m = 6;  ///< a lamp lights nothing beyond; its light ends smoothly there
  bool lamps = true;
};

/// Throws Error for options out of range.
void check_lighting(const LightingOptions& options);

/// Where lamps hang: just below every object called `ceiling_light`; without any, on a grid of 3 m
/// below the top of the world, at most 400.
std::vector<Eigen::Vector3d> lamps_of(const World& world, const LightingOptions& options);

/// Irradiance of a Lambertian surface at x with the normal n, towards the camera:
///
///     E = a (1 + 0.3 n·s) + Σ_lamps max(0, n·l) max(0, l_z) (1 - d²/R²)² / (1 + d²/4)
///
/// with l the direction to a lamp and d its distance in metres, within R, and s a fixed direction
/// by which faces differ that no lamp reaches. Lamps are flat and shine downwards; they shine
/// through walls unless shadows are traced.
double ambient_light(const Eigen::Vector3d& normal, const LightingOptions& options);
double lamp_light(const Eigen::Vector3d& x_m,
                  const Eigen::Vector3d& normal,
                  const Eigen::Vector3d& lamp_m,
                  const LightingOptions& options);

}  // namespace vernier::sim::internal
