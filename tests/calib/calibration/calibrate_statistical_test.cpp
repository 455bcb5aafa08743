// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "calib/calibration/cluster_robust_covariance.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/random.h"
#include "tests/support/chi_squared.h"
#include "tests/support/correlated_noise.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

// 150 calibrations of the same 15 views with fresh noise, seed 21. The normalised estimation error
// squared, summed, is chi-squared with 150 x 16 degrees of freedom; false-alarm rate 1 %,
// two-sided.
TEST(Calibrate, NormalisedErrorIsChiSquared) {
  const Rig truth = test::stereo_rig();
  const int trials = 150;
  double nees = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const auto board = simulate_board(truth, {7, 6, 0.035},
                                      {.seed = 21,
                                       .trial = static_cast<std::uint32_t>(trial),
                                       .frames = 15,
                                       .pixel_sigma_px = 0.2});
    const RigEstimate estimate = calibrate(board.observations, {.pixel_sigma_px = 0.2});
    const Eigen::VectorXd e = difference(estimate.rig, truth);
    nees += e.dot(Eigen::LLT<Eigen::MatrixXd>(*estimate.covariance_mvb).solve(e));
  }
  EXPECT_GT(nees, test::chi_squared_quantile(16 * trials, 0.005));
  EXPECT_LT(nees, test::chi_squared_quantile(16 * trials, 0.995));
}

// One frame alone determines the last of four parameters, as the pose of a camera that shares one
// frame with the others. Over 2000 draws of white noise the covariance is the truth times the
// variance of Student's t, 1.018; the mean has a standard error below 1 %, the limits are five.
TEST(ClusterRobustCovariance, HoldsWhereOneFrameAloneDeterminesAParameter) {
  constexpr int frames = 30, rows = 8, parameters = 4, draws = 2000;
  std::vector<Eigen::MatrixXd> A;
  RandomStream design({.seed = 5, .source = 200});
  ReducedNormalEquations equations;
  equations.information = Eigen::MatrixXd::Zero(parameters, parameters);
  for (int f = 0; f < frames; ++f) {
    A.emplace_back(Eigen::Map<const Eigen::MatrixXd>(design.normals(rows * parameters).data(), rows,
                                                     parameters));
    A[f].rightCols<1>().setZero();
    if (f == 3) A[f](0, 3) = 2;
    equations.frame_information.emplace_back(A[f].transpose() * A[f]);
    equations.information += equations.frame_information[f];
  }
  const Eigen::MatrixXd bound = equations.information.inverse();
  const std::vector<std::string> names{"a", "b", "c", "d"};
  Eigen::VectorXd ratio = Eigen::VectorXd::Zero(parameters), scatter = ratio;
  double inflation = 0;
  for (std::uint32_t draw = 0; draw < draws; ++draw) {
    RandomStream noise({.seed = 6, .trial = draw, .source = 200});
    std::vector<Eigen::VectorXd> e;
    Eigen::VectorXd b = Eigen::VectorXd::Zero(parameters);
    for (int f = 0; f < frames; ++f) {
      e.push_back(noise.normals(rows));
      b += A[f].transpose() * e[f];
    }
    const Eigen::VectorXd x = bound * b;
    equations.scores = Eigen::MatrixXd(parameters, frames);
    for (int f = 0; f < frames; ++f) equations.scores.col(f) = A[f].transpose() * (e[f] - A[f] * x);
    const Eigen::MatrixXd C = cluster_robust_covariance(equations, bound, names).matrix;
    ratio += C.diagonal().cwiseQuotient(bound.diagonal()) / draws;
    const ClusterScatter raw = scatter_of_clusters(equations, bound);
    const Eigen::VectorXd squares = raw.contributions.rowwise().squaredNorm();
    scatter += squares.cwiseQuotient(bound.diagonal()) / draws;
    inflation += raw.inflation / draws;
  }
  // 1.018 by Student's variance, and what the bound as the least adds to the mean
  for (int p = 0; p < parameters; ++p) EXPECT_NEAR(ratio[p], 1.08, 0.05) << p;
  // Without shrinkage unbiased, and nothing of what one frame alone determines. Each is known to
  // √(2 / (29 · 2000)) = 0.6 %.
  for (int p = 0; p + 1 < parameters; ++p) EXPECT_NEAR(scatter[p], 1, 0.03) << p;
  EXPECT_LT(scatter[3], 0.1);
  EXPECT_NEAR(inflation, 1, 0.03);
}

/// Mean normalised error squared over its degrees of freedom, by the bound and by the covariance.
struct Nees {
  double bound = 0, honest = 0;
};

/// Of the sets that can be calibrated.
Nees nees_of_sets(int frames, double smooth_px, double white_px, int sets, std::uint64_t seed) {
  const Rig truth = test::stereo_rig();
  Nees sum;
  int calibrated = 0;
  for (int set = 0; set < sets; ++set) {
    auto board = simulate_board(
        truth, {9, 6, 0.04},
        {.seed = seed + set, .frames = frames, .pixel_sigma_px = white_px, .distance_m = 0.7});
    test::add_smooth_error(board.observations, smooth_px, seed, set);
    RigEstimate estimate;
    try {
      estimate = calibrate(board.observations);
    } catch (const Error&) {
      continue;  // three views may not determine the rig
    }
    ++calibrated;
    const Eigen::VectorXd e = difference(estimate.rig, truth);
    sum.bound += e.dot(Eigen::LLT<Eigen::MatrixXd>(*estimate.covariance_mvb).solve(e));
    sum.honest += e.dot(Eigen::LLT<Eigen::MatrixXd>(estimate.covariance->matrix).solve(e));
  }
  EXPECT_GE(calibrated, 0.8 * sets);
  return {sum.bound / (16 * calibrated), sum.honest / (16 * calibrated)};
}

// 200 sets of 13 views, other poses in each, seeds 5000 to 5199 (the form was chosen on seeds 1000
// to 1199). The bound is shown failing; the bars of the honest covariance are the project's own.
TEST(ClusterRobustCovariance, IsTrueForThirteenViewsWithCorrelatedNoise) {
  const Nees nees = nees_of_sets(13, 0.1, 0.1, 200, 5000);
  RecordProperty("nees_bound", std::to_string(nees.bound));
  RecordProperty("nees_honest", std::to_string(nees.honest));
  EXPECT_GT(nees.bound, 4);
  EXPECT_GT(nees.honest, 0.8);
  EXPECT_LT(nees.honest, 1.3);
}

// 60 sets of 120 views with smooth errors, other poses in each, seeds 7000 to 7059; the bars are
// the project's own. With 960 errors the ratio's own scatter is about 3 %.
TEST(ClusterRobustCovariance, IsTrueForManyViewsWithCorrelatedNoise) {
  const Rig truth = test::stereo_rig();
  double honest = 0, bound = 0;
  const int sets = 60;
  for (int set = 0; set < sets; ++set) {
    auto board = simulate_board(truth, {9, 6, 0.04},
                                {.seed = 7000 + static_cast<std::uint64_t>(set),
                                 .frames = 120,
                                 .pixel_sigma_px = 0.1,
                                 .distance_m = 0.7});
    test::add_smooth_error(board.observations, 0.1, 7000, set);
    const RigEstimate estimate = calibrate(board.observations);
    ASSERT_EQ(estimate.covariance->kind, CovarianceKind::clustered);
    const Eigen::ArrayXd e2 = difference(estimate.rig, truth).array().square();
    honest += (e2 / estimate.covariance->matrix.diagonal().array()).mean() / sets;
    bound += (e2 / estimate.covariance_mvb->diagonal().array()).mean() / sets;
  }
  RecordProperty("sd_ratio_honest", std::to_string(std::sqrt(honest)));
  RecordProperty("sd_ratio_bound", std::to_string(std::sqrt(bound)));
  EXPECT_GT(std::sqrt(bound), 1.7);
  EXPECT_GT(std::sqrt(honest), 0.9);
  EXPECT_LT(std::sqrt(honest), 1.15);
}

/// So many sets with smooth errors and as many with white noise alone, seeds from `seed`: the mean
/// lies within the limits; the bound fails on the former.
void expect_true(int frames, int sets, int seed, double low, double high) {
  const auto first = static_cast<std::uint64_t>(seed + 100 * frames);
  const Nees smooth = nees_of_sets(frames, 0.1, 0.1, sets, first);
  const Nees white = nees_of_sets(frames, 0, 0.2, sets, first);
  testing::Test::RecordProperty("nees_smooth_" + std::to_string(frames),
                                std::to_string(smooth.honest));
  testing::Test::RecordProperty("nees_white_" + std::to_string(frames),
                                std::to_string(white.honest));
  EXPECT_GT(smooth.bound, 4) << frames;
  EXPECT_GT(smooth.honest, low) << frames;
  EXPECT_LT(smooth.honest, high) << frames;
  EXPECT_GT(white.honest, low) << frames;
  EXPECT_LT(white.honest, high) << frames;
}

// From three views per parameter on the scatter alone has full rank, and yet it is far too small in
// some directions: 2.0 and 1.4 on such sets of 48 and 90 views (the sandwich of Liang and Zeger,
// used before). Seeds of which nothing was chosen; the standard error of a mean is at most 0.06.
TEST(ClusterRobustCovariance, IsTrueFromThreeViewsPerParameterOn) {
  for (const int frames : {48, 90}) expect_true(frames, 40, 32000, 0.8, 1.2);
}

TEST(ClusterRobustCovariance, IsTrueForWhiteNoiseToo) {
  const Nees nees = nees_of_sets(13, 0, 0.2, 100, 6000);
  EXPECT_NEAR(nees.bound, 1, 0.15);
  EXPECT_GT(nees.honest, 0.8);
  EXPECT_LT(nees.honest, 1.3);
}

// 80 sets of 3, 4 and 6 views each, seeds from 8000; ν was chosen on seeds 11 to 70, of 3 to 13
// views. Without the factor, with the intensity of Ledoit and Wolf alone, 2.7, 1.9 and 1.3.
TEST(ClusterRobustCovariance, IsTrueForFewViews) {
  for (const int frames : {3, 4, 6}) expect_true(frames, 80, 8000, 0.7, 1.4);
}

}  // namespace
}  // namespace vernier
