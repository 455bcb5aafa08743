// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "calib/statistics/random.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/uncertainty_source.h"
#include "tests/support/chi_squared.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim::internal;
using namespace vernier::internal;
using namespace vernier::sim;

namespace {

const NoiseFreeView& seen() { return test::office_look(); }

// Seed 3, 40 trials. Sum of squares of end-point errors over sigma² is chi-squared; two-sided
// false-alarm rate 1e-3.
TEST(SourceStatistics, EndpointErrorHasItsSigma) {
  SourceSettings settings = no_sources();
  settings.endpoint_sigma_px = 0.15;
  const Sensor noisy(test::nominal_rig().rig, settings),
      clean(test::nominal_rig().rig, no_sources());
  double sum = 0;
  int n = 0;
  for (std::uint32_t trial = 0; trial < 40; ++trial) {
    const auto a = noisy.sense(seen(), {.seed = 3, .trial = trial}),
               b = clean.sense(seen(), {.seed = 3, .trial = trial});
    for (std::size_t i = 0; i < a.segments.size(); ++i) {
      sum += (a.segments[i].left.a_px - b.segments[i].left.a_px).squaredNorm() / 0.0225;
      sum += (a.segments[i].right.b_px - b.segments[i].right.b_px).squaredNorm() / 0.0225;
      n += 4;
    }
  }
  EXPECT_GT(sum, test::chi_squared_quantile(n, 5e-4));
  EXPECT_LT(sum, test::chi_squared_quantile(n, 1 - 5e-4));
}

// Seed 3, 60 trials. Shares lost and mismatched against their binomial expectation; two-sided
// false-alarm rate 1e-3 each (normal approximation).
TEST(SourceStatistics, CornerSharesAreAsSet) {
  SourceSettings settings = no_sources();
  settings.corner_loss = 0.15;
  settings.corner_mismatch = 0.1;
  settings.corner_mismatch_px = 10;
  const Sensor sensor(test::nominal_rig().rig, settings);
  double total = 0, kept = 0, wrong = 0;
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    const auto sighting = sensor.sense(seen(), {.seed = 3, .trial = trial});
    total += static_cast<double>(seen().corners.size());
    kept += static_cast<double>(sighting.corners.size());
    for (const SensedCorner& c : sighting.corners) wrong += c.mismatched;
  }
  const double z = normal_quantile(1 - 5e-4);
  EXPECT_NEAR(kept / total, 0.85, z * std::sqrt(0.15 * 0.85 / total));
  EXPECT_NEAR(wrong / kept, 0.1, z * std::sqrt(0.1 * 0.9 / kept));
}

}  // namespace
}  // namespace vernier
