// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/histograms/smeared_ramp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace vernier::localise::internal {
namespace {

/// Φ and its integral z Φ(z) + φ(z), tabulated over [-8, 8]; outside, both equal their limits to
/// 1e-15. Table step 1/256: the error of cubic interpolation with exact slopes is below 1e-11.
class NormalTable {
 public:
  NormalTable() {
    for (int i = 0; i <= steps; ++i) {
      const double z = -reach + i * step;
      density_[i] = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
      cdf_[i] = 0.5 * std::erfc(-z / std::numbers::sqrt2);
      integral_[i] = z * cdf_[i] + density_[i];
    }
  }
  double cdf(double z) const {
    if (z <= -reach) return 0;
    return z >= reach ? 1 : interpolate(z, cdf_, density_);
  }
  double integral(double z) const {
    if (z <= -reach) return 0;
    return z >= reach ? z : interpolate(z, integral_, cdf_);
  }

 private:
  static constexpr int reach = 8, steps = 2 * reach * 256;
  static constexpr double step = 1.0 / 256;
  using Column = std::array<double, steps + 1>;

  /// Cubic Hermite interpolation from values and slopes.
  static double interpolate(double z, const Column& value, const Column& slope) {
    const double at = (z + reach) / step;
    const int i = std::min(static_cast<int>(at), steps - 1);
    const double t = at - i, u = 1 - t;
    return u * u * ((1 + 2 * t) * value[i] + t * step * slope[i]) +
           t * t * ((1 + 2 * u) * value[i + 1] - u * step * slope[i + 1]);
  }

  Column density_, cdf_, integral_;
};

const NormalTable& normal_table() {
  static const NormalTable table;
  return table;
}

}  // namespace

double smeared_ramp_cdf(double x, double low, double high, double sigma) {
  const NormalTable& normal = normal_table();
  const double width = high - low;
  if (width < 1e-3 * sigma) return normal.cdf((x - 0.5 * (low + high)) / sigma);
  return sigma / width * (normal.integral((x - low) / sigma) - normal.integral((x - high) / sigma));
}

void add_smeared_ramp(
    std::span<float> bins, double max, double low, double high, double sigma, double mass) {
  const int n = static_cast<int>(bins.size());
  const double width = max / n;
  constexpr double reach = 4;  // in sigmas: 6e-5 of the mass is beyond
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

}  // namespace vernier::localise::internal
