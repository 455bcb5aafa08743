// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/poisson.h"

#include <cmath>

#include "calib/statistics/random.h"

namespace vernier::sim::internal {
namespace {

double by_inversion(vernier::internal::RandomStream& draws, double mean) {
  const double u = draws.uniform();
  double probability = std::exp(-mean), sum = probability, k = 0;
  while (u > sum && probability > 0) {
    ++k;
    probability *= mean / k;
    sum += probability;
  }
  return k;
}

/// log k!, by Stirling's series from 10 on; below, of the product.
double log_factorial(double k) {
  constexpr double half_log_2_pi = 0.91893853320467274178;
  if (k < 10) {
    double product = 1;
    for (double i = 2; i <= k; ++i) product *= i;
    return std::log(product);
  }
  const double x = k + 1, r = 1 / (x * x);
  return (x - 0.5) * std::log(x) - x + half_log_2_pi + (1.0 / 12 - (1.0 / 360 - r / 1260) * r) / x;
}

double by_rejection(vernier::internal::RandomStream& draws, double mean) {
  const double b = 0.931 + 2.53 * std::sqrt(mean), a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), v_r = 0.9277 - 3.6224 / (b - 2);
  while (true) {
    const double u = draws.uniform() - 0.5, v = draws.uniform();
    const double u_s = 0.5 - std::abs(u);
    const double k = std::floor((2 * a / u_s + b) * u + mean + 0.43);
    if (u_s >= 0.07 && v <= v_r) return k;
    if (k < 0 || (u_s < 0.013 && v > u_s)) continue;
    if (std::log(v * inverse_alpha / (a / (u_s * u_s) + b)) <=
        k * std::log(mean) - mean - log_factorial(k)) {
      return k;
    }
  }
}

}  // namespace

double draw_poisson(vernier::internal::RandomStream& draws, double mean) {
  constexpr double smallest_for_rejection = 10;
  if (!(mean > 0)) return 0;
  return mean < smallest_for_rejection ? by_inversion(draws, mean) : by_rejection(draws, mean);
}

}  // namespace vernier::sim::internal
