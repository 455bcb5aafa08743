// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/smeared_ramp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vernier {
namespace {

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// ∫ Φ up to z: z Φ(z) + φ(z).
double integrated_cdf(double z) {
  if (z < -8) return 0;
  if (z > 8) return z;
  return z * normal_cdf(z) + std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
}

}  // namespace

double smeared_ramp_cdf(double x, double low, double high, double sigma) {
  const double width = high - low;
  if (width < 1e-3 * sigma) return normal_cdf((x - 0.5 * (low + high)) / sigma);
  return sigma / width * (integrated_cdf((x - low) / sigma) - integrated_cdf((x - high) / sigma));
}

void add_smeared_ramp(
    std::span<float> bins, double max, double low, double high, double sigma, double mass) {
  const int n = static_cast<int>(bins.size());
  const double width = max / n;
  constexpr double reach = 4;  // sigmas that count: beyond is 6e-5 of the mass
  const int first = std::max(0, static_cast<int>((low - reach * sigma) / width));
  const int last = std::min(n - 1, static_cast<int>((high + reach * sigma) / width));
  const auto below = [&](double x) {
    const double direct = smeared_ramp_cdf(x, low, high, sigma);
    return low < reach * sigma ? direct - smeared_ramp_cdf(-x, low, high, sigma) : direct;
  };
  double before = below(first * width);
  for (int i = first; i <= last; ++i) {
    const double after = below((i + 1) * width);
    bins[i] += static_cast<float>(mass * (after - before));
    before = after;
  }
}

}  // namespace vernier
