// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/statistics/distributions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/statistics/chi_squared.h"
#include "calib/statistics/random.h"

namespace vernier::internal {
double chi_squared_cdf(double x, double dof) { return 1 - chi_squared_survival(x, dof); }

double chi_squared_quantile(double p, double dof) {
  const double v = 2 / (9 * dof);
  double x = dof * std::pow(std::max(0.01, 1 - v + normal_quantile(p) * std::sqrt(v)), 3);
  const double a = 0.5 * dof;
  int sign = 0;
  const double log_gamma = ::lgamma_r(a, &sign);  // std::lgamma writes a global
  for (int i = 0; i < 50; ++i) {
    const double density = 0.5 * std::exp((a - 1) * std::log(0.5 * x) - 0.5 * x - log_gamma);
    const double step = (chi_squared_cdf(x, dof) - p) / density;
    x = std::max(0.1 * x, x - step);
    if (std::abs(step) < 1e-12 * x) break;
  }
  return x;
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

double kolmogorov_smirnov_p(std::vector<double> sample, const std::function<double(double)>& cdf) {
  std::sort(sample.begin(), sample.end());
  const auto n = static_cast<double>(sample.size());
  double distance = 0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double F = cdf(sample[i]), below = static_cast<double>(i) / n;
    distance = std::max({distance, F - below, below + 1 / n - F});
  }
  const double root = std::sqrt(n), x = (root + 0.12 + 0.11 / root) * distance;
  if (x < 0.2) return 1;
  double p = 0;
  for (int k = 1; k < 100; ++k) p += (k % 2 ? 2 : -2) * std::exp(-2 * k * k * x * x);
  return std::clamp(p, 0.0, 1.0);
}

double draw_chi_squared(RandomStream& draws, double dof) {
  const double d = 0.5 * dof - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double z = draws.normal(), v = std::pow(1 + c * z, 3);
    if (v > 0 && std::log(draws.uniform()) < 0.5 * z * z + d - d * v + d * std::log(v)) {
      return 2 * d * v;
    }
  }
}

}  // namespace vernier::internal
