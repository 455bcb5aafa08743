// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/calibrate.h"
#include "calib/estimate/projection_difference.h"
#include "calib/rig.h"
#include "calib/rig_difference.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "tests/support/correlated_noise.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// Greatest distance between the empirical distribution and the uniform one, times √n
/// (Kolmogorov 1933): 1.63 is exceeded with probability 1 %.
double kolmogorov(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  const auto n = static_cast<double>(p.size());
  double most = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto k = static_cast<double>(i);
    most = std::max({most, std::abs(p[i] - k / n), std::abs(p[i] - (k + 1) / n)});
  }
  return most * std::sqrt(n);
}

// 200 pairs of calibrations of one rig, other views (seeds 700 and 900) and other noise (trial) in
// each; false-alarm rate 1 %.
TEST(RigDifference, PValuesOfIndependentCalibrationsAreUniform) {
  const Rig truth = test::stereo_rig();
  std::vector<double> p;
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    const auto of = [&](std::uint64_t seed, int frames) {
      return calibrate(
          simulate_board(truth, {7, 6, 0.035},
                         {.seed = seed, .trial = trial, .frames = frames, .pixel_sigma_px = 0.2})
              .observations,
          {.pixel_sigma_px = 0.2, .white_noise = true});
    };
    const RigEstimate a = of(700, 12), b = of(900, 20);
    p.push_back(rig_difference(a.rig, *a.covariance, b.rig, *b.covariance).p_value);
  }
  RecordProperty("kolmogorov", std::to_string(kolmogorov(p)));
  EXPECT_LT(kolmogorov(p), 1.63);
}

// 100 pairs of 13 views each with errors that are smooth over a view, seeds 7100 and 7300. The
// bound calls nearly all of them different; the covariance from the scatter is itself an estimate,
// so its p-values are near uniform only: at most 15 % fall below 5 %.
TEST(RigDifference, HonestCovarianceRarelyCallsCorrelatedNoiseADifference) {
  const Rig truth = test::stereo_rig();
  int honest = 0, bound = 0;
  const int pairs = 100;
  for (int pair = 0; pair < pairs; ++pair) {
    const auto of = [&](std::uint64_t seed) {
      auto board = simulate_board(
          truth, {9, 6, 0.04},
          {.seed = seed + pair, .frames = 13, .pixel_sigma_px = 0.1, .distance_m = 0.7});
      test::add_smooth_error(board.observations, 0.1, seed, pair);
      return calibrate(board.observations);
    };
    const RigEstimate a = of(7100), b = of(7300);
    const auto p = [&](CovarianceChoice choice) {
      return rig_difference(a.rig, *chosen_covariance(a, choice), b.rig,
                            *chosen_covariance(b, choice))
          .p_value;
    };
    honest += p(CovarianceChoice::honest) < 0.05;
    bound += p(CovarianceChoice::mvb) < 0.05;
  }
  RecordProperty("below_5_percent_honest", honest);
  RecordProperty("below_5_percent_bound", bound);
  EXPECT_LE(honest, 15);
  EXPECT_GT(bound, 80);
}

// 400 pairs drawn from the covariances of two calibrations (seeds 3 and 4). The mean squared
// difference has a relative standard deviation of about √(2 / 400 / 3 effective directions) = 4 %;
// the bar of 15 % allows for what is not linear as well.
TEST(ProjectionDifference, ExpectedSizeIsThatOfDrawnRigs) {
  const Rig truth = test::stereo_rig();
  const auto estimate = [&](std::uint64_t seed, int frames) {
    RigEstimate e =
        calibrate(simulate_board(truth, {}, {.seed = seed, .frames = frames}).observations,
                  {.white_noise = true});
    e.rig = truth;
    return e;
  };
  const RigEstimate a = estimate(3, 10), b = estimate(4, 20);
  const RigSampler draw_a(a), draw_b(b);
  const ProjectionDifferenceOptions options{.grid = {6, 5}};
  std::vector<double> squares(8, 0), in_focus(8, 0);
  const int trials = 400;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    const ProjectionDifference d =
        projection_difference(draw_a.sample(1, 3, trial), draw_b.sample(1, 4, trial), options);
    for (std::size_t m = 0; m < 8; ++m) {
      squares[m] += d.maps[m].after.rms_px * d.maps[m].after.rms_px / trials;
      in_focus[m] += d.maps[m].in_focus.rms_px * d.maps[m].in_focus.rms_px / trials;
    }
  }
  const ProjectionDifference expected =
      projection_difference(truth, truth, options, &*a.covariance, &*b.covariance);
  for (std::size_t m = 0; m < 8; ++m) {
    EXPECT_NEAR(squares[m] / std::pow(expected.maps[m].expected_rms_px, 2), 1, 0.15) << m;
    EXPECT_NEAR(in_focus[m] / std::pow(expected.maps[m].expected_in_focus_px, 2), 1, 0.15) << m;
  }
}

}  // namespace
}  // namespace vernier
