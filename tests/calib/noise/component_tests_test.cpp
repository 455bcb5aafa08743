// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/component_tests.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "calib/calibrate.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/noise_of_estimate.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

// Quantiles of the mixtures at 1 %, by tables of chi-squared: 6.635, 9.210 and 11.345 are those of
// one to three degrees of freedom.
TEST(ComponentTests, HaveTheTailsOfTheirMixtures) {
  EXPECT_NEAR(isotropy_test(0, 6.635).p_value, 0.01, 1e-5);
  EXPECT_NEAR(motion_test(0, 9.210).p_value, 0.5 * 0.0024067 + 0.25 * 0.01, 1e-5);
  EXPECT_NEAR(baseline_motion_test(0, 9.210).p_value,
              0.375 * 0.0024067 + 0.375 * 0.01 + 0.125 * 0.0266274, 1e-5);
  EXPECT_LT(motion_test(0, 8).p_value, baseline_motion_test(0, 8).p_value);
  for (const double without : {-0.13, 0.0, 5e-4}) {
    for (const auto test : {motion_test, baseline_motion_test, isotropy_test, shape_test}) {
      EXPECT_EQ(test(0, without).ratio, 0);
      EXPECT_EQ(test(0, without).p_value, 1);
    }
  }
}

// A model with a part is no worse than without it, wherever the fits start; what has a ratio of 0
// is reported as 0.
TEST(ComponentTests, AreOfNestedModels) {
  for (std::uint32_t t = 0; t < 4; ++t) {
    const CornerNoise noise{
        .white_px = 0.2, .motion_m = t < 2 ? 1e-4 : 0, .motion_baseline_m = t < 2 ? 5e-4 : 0};
    const auto drawn =
        test::noisy_board(test::stereo_rig(), {5, 4, 0.03},
                          {.seed = 831, .trial = t, .poses = t, .frames = 10}, noise);
    const RigEstimate estimate =
        calibrate(drawn.board.observations, {.reject_outliers = false, .check_input = false});
    const CornerNoiseEstimate found =
        estimate_corner_noise(estimate, {.shape = true, .baseline_motion = true});
    const double all = found.fit.solution.minus_two_log;
    for (const NoiseParts& fewer : {NoiseParts{.motion = false, .shape = true},
                                    NoiseParts{.shape = false}, NoiseParts{.shape = true}}) {
      const NoiseFit fit = fit_corner_noise(noise_likelihood(estimate, fewer), 0.03);
      // the fit is the isotropic one where that is not rejected: up to χ²_1 at 5 % above
      EXPECT_LT(all, fit.solution.minus_two_log + 3.85);
    }
    EXPECT_EQ(found.motion->ratio > 0, found.fit.noise.motion_m > 0);
    EXPECT_EQ(found.shape->ratio > 0, found.fit.noise.shape_height_m > 0);
    EXPECT_EQ(found.is_along_baseline(), found.fit.noise.motion_baseline_m > 0);
    EXPECT_EQ(found.fit.solution.motions.size(), 10U);
  }
}

// With the components at the mean of their variance, that of a motion is larger by ν / (ν − 2): of
// many frames by little, and never by more than 2.
TEST(ComponentTests, AreFollowedByTheMeanOfTheVariance) {
  double before = 2.1;
  for (const int frames : {9, 40}) {
    const auto drawn = test::noisy_board(test::stereo_rig(), {}, {.seed = 832, .frames = frames},
                                         {.white_px = 0.1, .motion_m = 5e-4});
    const RigEstimate estimate =
        calibrate(drawn.board.observations, {.reject_outliers = false, .check_input = false});
    const RestrictedLikelihood likelihood =
        noise_likelihood(estimate, {.field = false, .baseline_motion = true});
    const NoiseFit fit = fit_corner_noise(likelihood, 0.025);
    const CornerNoise mean = with_mean_motion(likelihood, fit);
    const double ratio = std::pow(mean.motion_baseline_m / fit.noise.motion_baseline_m, 2);
    // each frame has one motion along the baseline
    EXPECT_GT(ratio, frames / (frames - 2.0));
    EXPECT_LT(ratio, before);
    EXPECT_EQ(mean.white_px, fit.noise.white_px);
    before = 1.2;
  }
}

}  // namespace
}  // namespace vernier
