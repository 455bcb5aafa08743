// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/solver/refined_minimum.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/lens_models.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "calib/solver/initial_rig.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/normal_equations.h"
#include "calib/solver/square_root_system.h"
#include "calib/statistics/random.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

Eigen::MatrixXd random_matrix(int rows, int columns, std::uint32_t feature) {
  RandomStream draws({.seed = 5, .feature = feature});
  return draws.normals(rows * columns).reshaped(rows, columns);
}

TEST(SquareRootSystem, SolvesLikeTheDenseLeastSquaresProblem) {
  constexpr int p = 4, frames = 3, rows = 15;
  SquareRootSystem system(p);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(frames * rows + 2, p + 6 * frames);
  Eigen::VectorXd r(J.rows());
  for (int f = 0; f < frames; ++f) {
    const Eigen::MatrixXd M = random_matrix(rows, 6 + p + 1, f);
    system.add_frame(M);
    J.block(f * rows, p + 6 * f, rows, 6) = M.leftCols(6);
    J.block(f * rows, 0, rows, p) = M.middleCols(6, p);
    r.segment(f * rows, rows) = M.col(6 + p);
  }
  const Eigen::MatrixXd prior = random_matrix(2, p + 1, 9);
  system.add_rows(prior);
  J.bottomLeftCorner(2, p) = prior.leftCols(p);
  r.tail(2) = prior.col(p);
  const Eigen::VectorXd dense = test::least_squares(J, -r);
  const Eigen::VectorXd step = system.step();
  EXPECT_LT((step - dense.head(p)).norm(), 1e-13);
  EXPECT_LT((system.frame_steps(step) - dense.tail(6 * frames)).norm(), 1e-12);
  const Eigen::MatrixXd covariance = test::inverse(J.transpose() * J).topLeftCorner(p, p);
  EXPECT_LT((system.covariance() - covariance).norm(), 1e-12 * covariance.norm());
  EXPECT_NEAR(system.step_sigma(), std::sqrt(step.dot(test::inverse(covariance) * step)), 1e-12);
}

SimulatedBoard stereo_board() {
  return simulate_board(test::stereo_rig(OpenCv4{}), {9, 6, 0.04}, {.seed = 7, .frames = 15});
}

TEST(RefinedMinimum, TheScoreVanishesThere) {
  const SimulatedBoard board = stereo_board();
  const RefinedMinimum refined = refine_minimum(board.observations, board.truth);
  EXPECT_TRUE(refined.converged);
  const auto equations = reduced_normal_equations(board.observations, refined.state, 1.0);
  const Eigen::VectorXd score = equations.scores.rowwise().sum();
  const double distance_px = std::sqrt(score.dot(refined.unit_bound * score));
  EXPECT_LT(distance_px, 1e-9);
  EXPECT_NEAR(refined.cost_px2, equations.chi2, 1e-12 * equations.chi2);
}

TEST(RefinedMinimum, BoundIsThatOfTheNormalEquations) {
  const SimulatedBoard board = stereo_board();
  const RefinedMinimum refined = refine_minimum(board.observations, board.truth);
  const Eigen::MatrixXd bound =
      minimum_variance_bound(reduced_normal_equations(board.observations, refined.state, 1.0),
                             parameter_names(board.truth.rig));
  const Eigen::VectorXd sd = bound.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled = sd.cwiseInverse().asDiagonal() * (refined.unit_bound - bound) *
                                 sd.cwiseInverse().asDiagonal();
  EXPECT_LT(scaled.cwiseAbs().maxCoeff(), 1e-8);
}

TEST(RefinedMinimum, TheSolverOfRecordEndsThere) {
  const SimulatedBoard board = stereo_board();
  const BoardState start = initial_state(board.observations, {OpenCv4{}, OpenCv4{}});
  const BoardState ceres = minimise_reprojection(board.observations, start);
  const RefinedMinimum refined = refine_minimum(board.observations, ceres);
  EXPECT_TRUE(refined.converged);
  const Eigen::VectorXd delta = difference(refined.state.rig, ceres.rig);
  EXPECT_LT((delta.array() / (0.2 * refined.unit_bound.diagonal().array().sqrt())).abs().maxCoeff(),
            1e-4);
}

TEST(RefinedMinimum, HeldParametersStay) {
  const SimulatedBoard board = stereo_board();
  std::vector<bool> held(parameter_count(board.truth.rig));
  held[1] = held[9] = true;  // the aspect ratios
  const RefinedMinimum refined = refine_minimum(board.observations, board.truth, held);
  EXPECT_TRUE(refined.converged);
  EXPECT_EQ(refined.state.rig.cameras[0].ax(), board.truth.rig.cameras[0].ax());
  EXPECT_EQ(refined.unit_bound.row(9).norm(), 0);
  const RefinedMinimum free = refine_minimum(board.observations, board.truth);
  EXPECT_GT(refined.cost_px2, free.cost_px2);
  EXPECT_LT(refined.unit_bound(0, 0), free.unit_bound(0, 0));
}

TEST(RefinedMinimum, StaysWhereADirectionIsFree) {
  SimulatedBoard board = stereo_board();
  auto& views = board.observations.views;
  std::erase_if(views, [](const BoardView& view) { return view.frame != 0; });
  board.truth.frames.resize(1);
  board.truth.T_first_board.resize(1);
  const RefinedMinimum refined = refine_minimum(board.observations, board.truth);
  EXPECT_FALSE(refined.converged);
  EXPECT_LT(difference(refined.state.rig, board.truth.rig).norm(), 1e-15);
}

}  // namespace
}  // namespace vernier
