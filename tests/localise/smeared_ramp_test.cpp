// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/histograms/smeared_ramp.h"

#include <gtest/gtest.h>

#include <cmath>
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

TEST(SmearedRamp, CdfIsTheDenseSum) {
  for (const double width : {0.0, 1e-4, 0.01, 0.3, 2.0}) {
    for (double x = -1; x < 4; x += 0.37) {
      EXPECT_NEAR(smeared_ramp_cdf(x, 1, 1 + width, 0.2), dense_cdf(x, 1, 1 + width, 0.2), 1e-7);
    }
  }
}

TEST(SmearedRamp, MassIsKeptAwayFromTheEnds) {
  std::vector<float> bins(40, 0.0f);
  add_smeared_ramp(bins, 10, 3, 5, 0.3, 2.5);
  float sum = 0;
  for (const float b : bins) sum += b;
  EXPECT_NEAR(sum, 2.5, 1e-3);
}

TEST(SmearedRamp, MassBelowZeroIsReflectedAndBeyondTheEndLost) {
  std::vector<float> bins(20, 0.0f);
  add_smeared_ramp(bins, 5, 0, 0.1, 0.5, 1);
  float sum = 0;
  for (const float b : bins) sum += b;
  EXPECT_NEAR(sum, 1, 1e-3);
  std::fill(bins.begin(), bins.end(), 0.0f);
  add_smeared_ramp(bins, 5, 5, 5, 0.5, 1);
  sum = 0;
  for (const float b : bins) sum += b;
  EXPECT_NEAR(sum, 0.5, 1e-3);
}

}  // namespace
}  // namespace vernier
