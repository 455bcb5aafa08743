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
    if (!(z > -reach)) return 0;
    return z >= reach ? 1 : interpolate(z, cdf_, density_);
  }
  double integral(double z) const {
    if (!(z > -reach)) return 0;
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

/// 6e-5 of the mass is farther away, in sigmas.
constexpr double ramp_reach = 4;

/// Adds what is between the edges of the bins that [from, to] touches, where `below(x)` is the part
/// below the edge at x. The caller's from and to may be huge, but are numbers.
template <class Below>
void add_between_edges(std::span<float> bins,
                       double first_edge,
                       double width,
                       double from,
                       double to,
                       double mass,
                       Below below) {
  const auto n = static_cast<double>(bins.size());
  const int first = static_cast<int>(std::clamp((from - first_edge) / width, 0.0, n));
  const int last = static_cast<int>(std::clamp((to - first_edge) / width + 1, 0.0, n));
  if (first >= last) return;
  double before = below(first_edge + first * width);
  for (int i = first; i < last; ++i) {
    const double after = below(first_edge + (i + 1) * width);
    bins[i] += static_cast<float>(mass * (after - before));
    before = after;
  }
}

/// Whether sums and products of its numbers stay finite; not a number is refused.
bool is_moderate(const SmearedRamp& ramp) {
  constexpr double most = 1e100;
  return std::abs(ramp.low) < most && std::abs(ramp.high) < most && ramp.sigma < most;
}

}  // namespace

double mass_below(double x, const SmearedRamp& ramp) {
  const NormalTable& normal = normal_table();
  const auto& [low, high, sigma] = ramp;
  const double width = high - low;
  if (width < 1e-3 * sigma) return normal.cdf((x - 0.5 * (low + high)) / sigma);
  return sigma / width * (normal.integral((x - low) / sigma) - normal.integral((x - high) / sigma));
}

void add_magnitudes(std::span<float> bins, double max, const SmearedRamp& ramp, double mass) {
  if (!is_moderate(ramp)) return;
  const double reach = ramp_reach * ramp.sigma;
  const double nearest = std::max({ramp.low, -ramp.high, 0.0});
  const double farthest = std::max(ramp.high, -ramp.low);
  const bool reflected = ramp.low < reach;
  add_between_edges(bins, 0, max / static_cast<double>(bins.size()), nearest - reach,
                    farthest + reach, mass, [&](double x) {
                      const double direct = mass_below(x, ramp);
                      return reflected ? direct - mass_below(-x, ramp) : direct;
                    });
}

void add_signed(std::span<float> bins, double max, const SmearedRamp& ramp, double mass) {
  if (!is_moderate(ramp)) return;
  const double reach = ramp_reach * ramp.sigma;
  add_between_edges(bins, -max, 2 * max / static_cast<double>(bins.size()), ramp.low - reach,
                    ramp.high + reach, mass, [&](double x) { return mass_below(x, ramp); });
}

}  // namespace vernier::localise::internal
