// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/texture.h"

#include <cmath>
#include <numbers>

#include "calib/statistics/random.h"

namespace vernier::sim::internal {

Texture::Texture(double scale_m, vernier::internal::RandomStream& draws) {
  constexpr double pi = std::numbers::pi;
  constexpr int octaves = 3;
  double power = 0;
  for (int k = 0; k < waves; ++k) {
    const double octave = std::exp2(k % octaves);
    const double frequency = octave * draws.uniform(0.8, 1.25) / scale_m;
    const double direction = pi * (k / octaves + draws.uniform()) / (waves / octaves);
    x_[k] = frequency * std::cos(direction);
    y_[k] = frequency * std::sin(direction);
    phase_[k] = draws.uniform();
    amplitude_[k] = static_cast<float>(1 / octave);
    decay_[k] = static_cast<float>(-2 * pi * pi * frequency * frequency);
    power += 0.5 / (octave * octave);
  }
  amplitude_ /= static_cast<float>(std::sqrt(power));
}

float Texture::at(double x_m, double y_m, double blur_m) const {
  const Eigen::Array<double, waves, 1> cycles = x_ * x_m + y_ * y_m + phase_;
  const Eigen::Array<float, waves, 1> turn =
      static_cast<float>(2 * std::numbers::pi) * (cycles - cycles.floor()).cast<float>();
  const auto blur2 = static_cast<float>(blur_m * blur_m);
  return (amplitude_ * (decay_ * blur2).exp() * turn.cos()).sum();
}

}  // namespace vernier::sim::internal
