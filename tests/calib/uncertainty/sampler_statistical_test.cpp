// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>

#include "calib/base/decompositions.h"
#include "calib/calibrate.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/simulated_board.h"
#include "calib/statistics/random.h"
#include "tests/support/chi_squared.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

RigEstimate sampled_estimate() {
  static const RigEstimate estimate =
      calibrate(simulate_board(test::stereo_rig(), {}, {.seed = 3}).observations);
  return estimate;
}

// Seed 11 fixed. With W the whitened sample scatter of n = 10,000 draws in p = 16 dimensions,
// trace(W) is chi-squared with n p degrees of freedom, and so is n times each diagonal element with
// n; off-diagonal elements have standard deviation 1/sqrt(n). False-alarm rate: two-sided 1e-3 for
// the trace, 1e-3 over all the others together (Bonferroni over 136).
TEST(Sampler, TenThousandDrawsReproduceTheCovariance) {
  const RigSampler sampler(sampled_estimate());
  const int n = 10000, p = 16;
  const Cholesky L(sampled_estimate().covariance->matrix);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(p, p);
  for (int i = 0; i < n; ++i) {
    const Eigen::VectorXd z = L.solve_lower(sampler.deviation(1, 11, i));
    W += z * z.transpose();
  }
  EXPECT_GT(W.trace(), test::chi_squared_quantile(n * p, 5e-4));
  EXPECT_LT(W.trace(), test::chi_squared_quantile(n * p, 1 - 5e-4));
  const double alarm = 1e-3 / 136;
  for (int i = 0; i < p; ++i) {
    EXPECT_GT(W(i, i), test::chi_squared_quantile(n, alarm / 2));
    EXPECT_LT(W(i, i), test::chi_squared_quantile(n, 1 - alarm / 2));
    for (int j = 0; j < i; ++j) {
      EXPECT_LT(std::abs(W(i, j)) / n, normal_quantile(1 - alarm / 2) / std::sqrt(n));
    }
  }
}

// The extreme eigenvalues, against the same statistic of a Wishart matrix simulated from
// independent draws: inside its range over 200 repeats (false-alarm rate 1 % a tail).
TEST(Sampler, ExtremeEigenvaluesAreThoseOfAWishart) {
  const RigSampler sampler(sampled_estimate());
  const int n = 2000, p = 16;
  const auto extremes = [&](const Eigen::MatrixXd& scatter) {
    const Eigen::VectorXd e = symmetric_eigenvalues(scatter / n);
    return std::pair(e[0], e[p - 1]);
  };
  double lowest = 1, lowest_high = 9, highest = 1, highest_low = 0;
  for (int repeat = 0; repeat < 200; ++repeat) {
    RandomStream draws({.seed = 99, .trial = static_cast<std::uint32_t>(repeat)});
    Eigen::MatrixXd Z(p, n);
    for (int i = 0; i < n; ++i) Z.col(i) = draws.normals(p);
    const auto [low, high] = extremes(Z * Z.transpose());
    lowest = std::min(lowest, low);
    highest_low = std::max(highest_low, low);
    highest = std::max(highest, high);
    lowest_high = std::min(lowest_high, high);
  }
  const Cholesky L(sampled_estimate().covariance->matrix);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(p, p);
  for (int i = 0; i < n; ++i) {
    const Eigen::VectorXd z = L.solve_lower(sampler.deviation(1, 12, i));
    W += z * z.transpose();
  }
  const auto [low, high] = extremes(W);
  EXPECT_GT(low, lowest);
  EXPECT_LT(low, highest_low);
  EXPECT_GT(high, lowest_high);
  EXPECT_LT(high, highest);
}

TEST(Sampler, PsiCScalesDeviationsExactly) {
  const RigSampler sampler(sampled_estimate());
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const Eigen::VectorXd one = sampler.deviation(1, 5, trial);
    EXPECT_EQ(sampler.deviation(2, 5, trial), 2 * one);
    // The rig is where the deviation says, to the first order in the tangent.
    constexpr double small = 1e-6;
    const Eigen::VectorXd moved =
        difference(sampler.sample(small, 5, trial), sampler.mean()) / small;
    const Eigen::VectorXd sigma = sampled_estimate().covariance->matrix.diagonal().cwiseSqrt();
    EXPECT_LT((moved - one).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 1e-3);
  }
}

}  // namespace
}  // namespace vernier
