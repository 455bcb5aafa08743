// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/sources/variance_line.h"

#include "calib/statistics/quantile.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/statistics/distributions.h"

namespace vernier::sim::internal {

using namespace vernier::internal;

namespace {

/// Of |squares|; robust against a few large ones.
double median_square(const std::vector<SquareSample>& samples) {
  std::vector<double> squares;
  squares.reserve(samples.size());
  for (const SquareSample& sample : samples) squares.push_back(std::abs(sample.square));
  return median_or_zero(std::move(squares));
}

/// Variance of a standard normal truncated at ± cut, per sample kept, relative to 1.
double kept_variance(double cut) {
  if (!(cut > 0)) return 1;
  const double density = std::exp(-0.5 * cut * cut) / std::sqrt(2 * M_PI);
  return 1 - 2 * cut * density / (2 * normal_cdf(cut) - 1);
}

VarianceLine weighted_fit(const std::vector<SquareSample>& samples,
                          const VarianceLine& last,
                          double floor,
                          double cut) {
  double w0 = 0, w1 = 0, w2 = 0, s0 = 0, s1 = 0;
  for (const SquareSample& sample : samples) {
    const double expected = std::max(floor, last.own + sample.share * last.other);
    if (cut > 0 && sample.square > cut * cut * expected) continue;
    const double weight = 1 / std::pow(expected + sample.noise, 2);
    w0 += weight;
    w1 += weight * sample.share;
    w2 += weight * sample.share * sample.share;
    s0 += weight * sample.square;
    s1 += weight * sample.share * sample.square;
  }
  if (!(w0 > 0)) return last;
  const double determinant = w0 * w2 - w1 * w1;
  VarianceLine line{s0 / w0, 0};
  if (determinant > 1e-9 * w0 * w2) {
    const VarianceLine both{(w2 * s0 - w1 * s1) / determinant, (w0 * s1 - w1 * s0) / determinant};
    if (both.other > 0) line = both;
    if (both.other > 0 && both.own < 0) line = {0, w2 > 0 ? s1 / w2 : 0};
  }
  const double kept = kept_variance(cut);
  return {std::max(0.0, line.own) / kept, std::max(0.0, line.other) / kept};
}

}  // namespace

VarianceLine variance_line(const std::vector<SquareSample>& samples, double cut) {
  if (samples.size() < 2) return {};
  constexpr int rounds = 12;
  const double middle = median_square(samples);
  VarianceLine line{middle / 0.455, 0};  // the median of χ² with one degree of freedom
  for (int i = 0; i < rounds; ++i) line = weighted_fit(samples, line, 0.1 * middle, cut);
  return line;
}

}  // namespace vernier::sim::internal
