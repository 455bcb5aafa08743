// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Seeds are fixed; a right covariance fails consistent() for at most 3 seeds of 100.
#include <gtest/gtest.h>

#include <Eigen/Core>

#include "calib/base/decompositions.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/lens_models.h"
#include "calib/rig_prior.h"
#include "calib/simulated_board.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "calib/validation/monte_carlo_check.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr double sigma_px = 0.2;

struct Calibrated {
  SimulatedBoard board;
  ReprojectionProblem problem{.pixel_sigma_px = sigma_px};
  Eigen::MatrixXd covariance;

  explicit Calibrated(const CameraModel& model = Radial1{},
                      const std::vector<HeldParameter>& held = {})
      : board(simulate_board(test::stereo_rig(model),
                             {8, 6, 0.03},
                             {.seed = 3, .frames = 20, .pixel_sigma_px = 0, .distance_m = 0.8})) {
    problem.held = held_mask(board.truth.rig, held);
    const auto E = free_directions(board.truth.rig, problem.held);
    const auto equations =
        restricted(reduced_normal_equations(board.observations, board.truth, sigma_px), E);
    covariance = E * minimum_variance_bound(equations, free_names(board.truth.rig, problem.held)) *
                 E.transpose();
  }

  MonteCarloCheck check(const Eigen::MatrixXd& C, int trials = 500, int threads = 2) const {
    return monte_carlo_check(board.observations, board.truth, problem, C,
                             {.trials = trials, .seed = 12, .threads = threads});
  }
};

TEST(MonteCarloCheck, TheBoundIsRightForWhiteNoise) {
  for (const char* model : {"radial1", "opencv4", "opencv5"}) {
    const Calibrated calibrated(camera_model(model));
    const MonteCarloCheck check = calibrated.check(calibrated.covariance);
    EXPECT_EQ(check.trials, 500) << model;
    RecordProperty(std::string("nees_") + model,
                   std::to_string(check.nees_mean) + " of " + std::to_string(check.nees_expected));
    RecordProperty(std::string("eigenvalues_") + model,
                   std::to_string(check.eigenvalues[0]) + " " +
                       std::to_string(check.eigenvalues[check.eigenvalues.size() - 1]) + " in " +
                       std::to_string(check.eigenvalue_band_99.low) + " " +
                       std::to_string(check.eigenvalue_band_99.high));
    RecordProperty(std::string("ks_p_") + model, std::to_string(check.ks_p) + ", components " +
                                                     std::to_string(check.ks_p_components));
    EXPECT_TRUE(check.consistent())
        << model << ": NEES " << check.nees_mean << " of " << check.nees_expected
        << ", eigenvalues " << check.eigenvalues[0] << " " << check.eigenvalues[1] << " in "
        << check.eigenvalue_band_99.low << " " << check.eigenvalue_band_99.high << ", p "
        << check.ks_p << " " << check.ks_p_components;
    EXPECT_EQ(check.nees_expected, calibrated.covariance.rows());
    EXPECT_GT(check.std_ratio_min, 0.88);  // 3.7 standard deviations of a ratio from 500 trials
    EXPECT_LT(check.std_ratio_max, 1.12);
  }
}

TEST(MonteCarloCheck, OneDirectionATwentyPerCentTooNarrowIsCaught) {
  const Calibrated calibrated;
  const Eigen::MatrixXd L = Cholesky(calibrated.covariance).lower();
  int caught = 0;
  for (int k = 0; k < 16; ++k) {  // every direction of the whitened parameters in turn
    Eigen::VectorXd d = Eigen::VectorXd::Constant(16, 0.3);
    d[k] += 1;
    d.normalize();
    const Eigen::MatrixXd narrow =
        L * (Eigen::MatrixXd::Identity(16, 16) - (1 - 0.64) * d * d.transpose()) * L.transpose();
    caught += !calibrated.check(narrow).consistent();
  }
  EXPECT_GE(caught, 15);
}

TEST(MonteCarloCheck, AWrongPixelSigmaIsCaught) {
  const Calibrated calibrated;
  EXPECT_FALSE(calibrated.check(1.1 * calibrated.covariance).consistent());
  EXPECT_FALSE(calibrated.check(calibrated.covariance / 1.1).consistent());
}

TEST(MonteCarloCheck, DoesNotDependOnThreads) {
  const Calibrated calibrated;
  const MonteCarloCheck one = calibrated.check(calibrated.covariance, 100, 1);
  const MonteCarloCheck three = calibrated.check(calibrated.covariance, 100, 3);
  EXPECT_EQ(one.nees_mean, three.nees_mean);
  EXPECT_EQ(one.std_ratios, three.std_ratios);
  EXPECT_EQ(one.ks_p, three.ks_p);
  EXPECT_EQ(one.eigenvalue_band_99, three.eigenvalue_band_99);
}

TEST(MonteCarloCheck, HeldParametersHaveNoShareInIt) {
  const Calibrated calibrated(Radial1{}, {{"left.ax"}, {"right.wx_rad"}});
  const MonteCarloCheck check = calibrated.check(calibrated.covariance);
  EXPECT_EQ(check.nees_expected, 14);
  EXPECT_EQ(check.std_ratios[1], 0);
  EXPECT_TRUE(check.consistent()) << check.nees_mean << " " << check.ks_p;
}

TEST(MonteCarloCheck, CopiesThatCannotBeSolvedSpeakAgainstIt) {
  const Calibrated calibrated;
  MonteCarloCheck check = calibrated.check(calibrated.covariance);
  ASSERT_TRUE(check.consistent());
  check.failed = 5;  // of 505
  EXPECT_TRUE(check.consistent());
  check.failed = 6;
  EXPECT_FALSE(check.consistent());
  EXPECT_FALSE(check.enough_trials_solved());
  EXPECT_TRUE(check.scatter_matches_covariance());
}

// A view's noise is its own: leaving out another view changes what is estimated from it, not what
// was drawn.
TEST(MonteCarloCheck, NoiseDoesNotDependOnTheOtherViews) {
  const Calibrated all;
  Calibrated less = all;
  less.board.observations.views.erase(less.board.observations.views.begin());
  less.covariance = minimum_variance_bound(
      reduced_normal_equations(less.board.observations, less.board.truth, sigma_px),
      parameter_names(less.board.truth.rig));
  const MonteCarloCheck a = all.check(all.covariance, 100), b = less.check(less.covariance, 100);
  double squares = 0;
  for (std::size_t i = 0; i < 16; ++i) squares += std::pow(a.std_ratios[i] - b.std_ratios[i], 2);
  EXPECT_LT(std::sqrt(squares / 16), 0.04);  // other noise: 0.1
}

TEST(MonteCarloCheck, PriorsAreDrawnToo) {
  Calibrated calibrated;
  Eigen::VectorXd sd = calibrated.covariance.diagonal().cwiseSqrt();
  RigPrior prior{calibrated.board.truth.rig, Eigen::MatrixXd::Zero(16, 16)};
  for (const int i : {0, 1, 11, 13}) prior.information(i, i) = 1 / (sd[i] * sd[i]);
  calibrated.problem.priors = {prior};
  const Eigen::MatrixXd posterior =
      test::inverse(test::inverse(calibrated.covariance) + prior.information);
  EXPECT_TRUE(calibrated.check(posterior).consistent());
  EXPECT_FALSE(calibrated.check(calibrated.covariance).consistent());
}

TEST(MonteCarloCheck, NamesWhatIsWrong) {
  const Calibrated calibrated;
  const auto message = [](const auto& f) {
    try {
      f();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing thrown");
  };
  EXPECT_EQ(message([&] { calibrated.check(Eigen::MatrixXd::Identity(3, 3)); }),
            "covariance: its size does not match the number of the rig's parameters; give it in "
            "full, with "
            "zeros for fixed parameters");
  EXPECT_EQ(message([&] { calibrated.check(calibrated.covariance, 20); }),
            "Monte-Carlo check: 20 trials are too few for 16 parameters; ask for at least 32");
  EXPECT_EQ(message([&] { require_enough_trials(calibrated.covariance, 1); }),
            "Monte-Carlo check: 1 trial is too few for 16 parameters; ask for at least 32");
  EXPECT_EQ(message([&] { require_enough_trials(calibrated.covariance, 32); }), "nothing thrown");
}

TEST(MonteCarloCheck, NamesEachStatisticOutsideItsBand) {
  MonteCarloCheck check;
  check.nees_mean = 14.65;
  check.nees_interval_99 = {12.1, 16};
  check.eigenvalues = {0.2, 2.651};
  check.eigenvalue_band_99 = {0.1, 2.642};
  check.ks_p = check.ks_p_components = 0.4;
  EXPECT_EQ(check.departures(),
            std::vector<std::string>{"the largest eigenvalue of the whitened samples is 2.651, "
                                     "outside [0.1, 2.642]"});
  EXPECT_FALSE(check.scatter_matches_covariance());
  check.eigenvalues[1] = 2.6;
  EXPECT_TRUE(check.scatter_matches_covariance());
  check = {.nees_mean = 17,
           .nees_interval_99 = {12.1, 16},
           .eigenvalues = {0.05, 1},
           .eigenvalue_band_99 = {0.1, 2.642},
           .ks_p = 0.001,
           .ks_p_components = std::nan("")};
  EXPECT_EQ(check.departures().size(), 4u);
}

TEST(Distributions, ChiSquared) {
  // Abramowitz and Stegun, table 26.8.
  EXPECT_NEAR(chi_squared_quantile(0.95, 10), 18.30703805, 1e-7);
  EXPECT_NEAR(chi_squared_quantile(0.005, 2), 0.01002508, 1e-7);
  EXPECT_NEAR(chi_squared_cdf(63.69073975, 100), 1 - 0.998213, 5e-4);
  for (const double p : {0.001, 0.3, 0.999}) {
    EXPECT_NEAR(chi_squared_cdf(chi_squared_quantile(p, 8000), 8000), p, 1e-10);
  }
  RandomStream draws({.seed = 5});
  double sum = 0, squares = 0;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double x = draw_chi_squared(draws, 7);
    sum += x;
    squares += x * x;
  }
  // Four standard deviations: one false alarm in 16 000 seeds each.
  EXPECT_NEAR(sum / n, 7, 4 * std::sqrt(14.0 / n));
  EXPECT_NEAR(squares / n - sum / n * sum / n, 14,
              4 * std::sqrt((2 * 14.0 * 14 + 12 * 7 * 4.0) / n));
}

TEST(Distributions, KolmogorovSmirnov) {
  std::vector<double> even;
  for (int i = 0; i < 1000; ++i) even.push_back((i + 0.5) / 1000);
  const auto uniform = [](double x) { return x; };
  EXPECT_EQ(kolmogorov_smirnov_p(even, uniform), 1);
  for (double& x : even) x = x * x;
  EXPECT_LT(kolmogorov_smirnov_p(even, uniform), 1e-10);
  // 1.36 / sqrt(n) is the classic 5 % point.
  std::vector<double> shifted;
  for (int i = 0; i < 10000; ++i) shifted.push_back((i + 0.5) / 10000 + 0.01358);
  EXPECT_NEAR(kolmogorov_smirnov_p(shifted, uniform), 0.05, 0.002);
}

}  // namespace
}  // namespace vernier
