// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/histograms/smeared_ramp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace vernier {

using namespace vernier::localise::internal;

namespace {

/// The same by summing Gaussians at dense points of the ramp.
double dense_cdf(double x, double low, double high, double sigma) {
  double sum = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double at = low + (high - low) * (i + 0.5) / n;
    sum += 0.5 * std::erfc(-(x - at) / sigma / std::sqrt(2.0));
  }
  return sum / n;
}

float sum(const std::vector<float>& bins) {
  return std::accumulate(bins.begin(), bins.end(), 0.0f);
}

TEST(SmearedRamp, MassBelowIsTheDenseSum) {
  for (const double width : {0.0, 1e-4, 0.01, 0.3, 2.0}) {
    for (double x = -1; x < 4; x += 0.37) {
      EXPECT_NEAR(mass_below(x, {1, 1 + width, 0.2}), dense_cdf(x, 1, 1 + width, 0.2), 1e-7);
    }
  }
}

TEST(SmearedRamp, MassIsKeptAwayFromTheEnds) {
  std::vector<float> bins(40, 0.0f);
  add_magnitudes(bins, 10, {3, 5, 0.3}, 2.5);
  EXPECT_NEAR(sum(bins), 2.5, 1e-3);
  std::fill(bins.begin(), bins.end(), 0.0f);
  add_signed(bins, 10, {-5, 3, 0.3}, 2.5);
  EXPECT_NEAR(sum(bins), 2.5, 1e-3);
}

TEST(SmearedRamp, MassBelowZeroIsReflectedAndBeyondTheEndLost) {
  std::vector<float> bins(20, 0.0f);
  add_magnitudes(bins, 5, {0, 0.1, 0.5}, 1);
  EXPECT_NEAR(sum(bins), 1, 1e-3);
  std::fill(bins.begin(), bins.end(), 0.0f);
  add_magnitudes(bins, 5, {5, 5, 0.5}, 1);
  EXPECT_NEAR(sum(bins), 0.5, 1e-3);
  std::fill(bins.begin(), bins.end(), 0.0f);
  add_signed(bins, 5, {-5, -5, 0.5}, 1);
  EXPECT_NEAR(sum(bins), 0.5, 1e-3);
}

/// Magnitudes are the signed histogram folded at zero.
TEST(SmearedRamp, MagnitudesAreTheSignedRampFolded) {
  const std::vector<SmearedRamp> ramps = {
      {-2, 3, 0.2}, {-3, -1, 0.4}, {-0.3, 0.1, 1}, {2, 4.9, 0.3}, {-4, 4, 0.001}};
  for (const SmearedRamp& ramp : ramps) {
    std::vector<float> folded(20, 0.0f), both(40, 0.0f);
    add_magnitudes(folded, 5, ramp, 1);
    add_signed(both, 5, ramp, 1);
    for (int i = 0; i < 20; ++i) EXPECT_NEAR(folded[i], both[20 + i] + both[19 - i], 2e-4) << i;
  }
}

/// Casts of what exceeds an int are undefined, and seen by the sanitizers.
TEST(SmearedRamp, HugeOrMissingNumbersAddNothing) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const double far : {1e12, 1e90, 1e250, inf, nan}) {
    std::vector<float> bins(20, 0.0f);
    for (const SmearedRamp& ramp : std::vector<SmearedRamp>{
             {far, far, 0.3}, {-far, -far, 0.3}, {far, far + 1, 1e-9}, {1, 2, 1e5 * far}}) {
      add_magnitudes(bins, 5, ramp, 1);
      add_signed(bins, 5, ramp, 1);
    }
    EXPECT_NEAR(sum(bins), 0, 1e-6) << far;
    add_magnitudes(bins, 5, {-far, far, 0.3}, 1);  // crosses the bins, and leaves hardly anything
    add_signed(bins, 5, {-far, far, 0.3}, 1);
    EXPECT_NEAR(sum(bins), 0, 1e-6) << far;
  }
}

}  // namespace
}  // namespace vernier
