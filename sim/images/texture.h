// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "calib/statistics/random.h"

namespace vernier::sim::internal {

/// A band-limited texture, of root mean square 1 over the plane: plane waves in three octaves,
///
///     t(p) = Σ_k a_k cos(2π (f_k · p + φ_k)),   |f_k| = 2^j c_k / scale,   a_k ~ 2^-j,   j = 0, 1,
///     2
///
/// with directions uniform within sectors of 45°, uniform phases and c_k in [0.8, 1.25]; so its
/// spectrum falls as that of natural images does, with the square of the frequency (Field,
/// "Relations between the statistics of natural images and the response properties of cortical
/// cells", 1987). A Gaussian of deviation s, for the area that a pixel sees, multiplies a wave by
/// exp(-2π² |f_k|² s²), which makes it free of aliasing.
class Texture {
 public:
  static constexpr int waves = 12;

  /// Draws from `draws`; `scale_m` is the longest wavelength.
  Texture(double scale_m, vernier::internal::RandomStream& draws);

  /// At a point of the plane (metres), seen through a Gaussian of `blur_m`.
  float at(double x_m, double y_m, double blur_m) const;

 private:
  Eigen::Array<double, waves, 1> x_, y_, phase_;  // cycles per metre, cycles
  Eigen::Array<float, waves, 1> amplitude_, decay_;
};

}  // namespace vernier::sim::internal
