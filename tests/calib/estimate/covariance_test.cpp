// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "calib/board/view_linearisation.h"
#include "calib/board_observations.h"
#include "calib/calibration/minimum_variance_bound.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/simulated_board.h"
#include "calib/solver/normal_equations.h"
#include "calib/statistics/scaled_root.h"
#include "calib/uncertainty/joint_information.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/error_message.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// All residuals as a function of (rig tangent, pose tangents): the dense, unreduced problem.
Eigen::VectorXd residuals(const SimulatedBoard& board, const Eigen::VectorXd& delta) {
  const int n = parameter_count(board.truth.rig);
  const Rig rig = retract(board.truth.rig, delta.head(n));
  std::vector<double> all;
  ViewLinearisation J;
  for (const BoardView& view : board.observations.views) {
    const Pose T =
        retract(board.truth.T_first_board[view.frame], delta.segment<6>(n + 6 * view.frame));
    linearise_view(rig.cameras[view.camera], rig.T_camera_first[view.camera], T,
                   board.observations.target_m, view, Linearise::residual_only, J);
    all.insert(all.end(), J.residual_px.begin(), J.residual_px.end());
  }
  return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

TEST(Covariance, SchurComplementIsTheBlockOfTheFullInverse) {
  const SimulatedBoard board =
      simulate_board(test::stereo_rig(), {6, 5, 0.04}, {.seed = 2, .frames = 8});
  const int n = parameter_count(board.truth.rig);
  const Eigen::MatrixXd J =
      test::numeric_jacobian([&](const Eigen::VectorXd& d) { return residuals(board, d); },
                             Eigen::VectorXd::Zero(n + 6 * 8), 1e-4);
  Eigen::MatrixXd H = J.transpose() * J / 0.04;
  const Eigen::VectorXd s = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd full =
      s.asDiagonal() * test::inverse(s.asDiagonal() * H * s.asDiagonal()) * s.asDiagonal();
  const auto equations = reduced_normal_equations(board.observations, board.truth, 0.2);
  const Eigen::MatrixXd C = minimum_variance_bound(equations, parameter_names(board.truth.rig));
  const Eigen::VectorXd sd = C.diagonal().cwiseSqrt();
  const Eigen::MatrixXd normalised = sd.cwiseInverse().asDiagonal() *
                                     (C - full.topLeftCorner(n, n)) *
                                     sd.cwiseInverse().asDiagonal();
  EXPECT_LT(normalised.cwiseAbs().maxCoeff(), 1e-5);  // limited by the numeric derivative
}

TEST(Covariance, InformationAddsUp) {
  const SimulatedBoard board = simulate_board(test::stereo_rig(), {}, {.seed = 2});
  const auto whole = reduced_normal_equations(board.observations, board.truth, 0.2);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(16, 16);
  for (int parity = 0; parity < 2; ++parity) {
    SimulatedBoard part = board;
    std::erase_if(part.observations.views,
                  [&](const BoardView& v) { return v.frame % 2 != parity; });
    part.truth.frames.clear();
    part.truth.T_first_board.clear();
    for (int f = parity; f < 20; f += 2) {
      part.truth.frames.push_back(f);
      part.truth.T_first_board.push_back(board.truth.T_first_board[f]);
    }
    sum += reduced_normal_equations(part.observations, part.truth, 0.2).information;
  }
  EXPECT_LT((sum - whole.information).cwiseAbs().maxCoeff(),
            1e-9 * whole.information.cwiseAbs().maxCoeff());
}

TEST(Covariance, AFreeDirectionIsNamed) {
  // One frame, fronto-parallel: focal length and distance cannot be told apart.
  SimulatedBoard board = simulate_board(test::stereo_rig(Pinhole{}), {}, {.seed = 2, .frames = 1});
  board.observations.views.pop_back();
  board.truth.rig.cameras.pop_back();
  board.truth.rig.T_camera_first.pop_back();
  board.observations.size_px.pop_back();
  board.truth.T_first_board[0] = {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 1}};
  const auto equations = reduced_normal_equations(board.observations, board.truth, 0.2);
  try {
    minimum_variance_bound(equations, parameter_names(board.truth.rig));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("leave a direction undetermined"), std::string::npos);
  }
}

TEST(ScaledDecomposition, FactorReproducesTheCovariance) {
  Covariance c{CovarianceKind::prior, {"left.f_px", "right.ox_px", "right.wy_rad"}, {}};
  c.matrix.resize(3, 3);
  c.matrix << 4, 0.2, 0, 0.2, 1, -0.0099, 0, -0.0099, 1e-4;
  const ScaledDecomposition d(c);
  EXPECT_LT((d.factor() * d.factor().transpose() - c.matrix).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GE(d.directions()[0].variance_share, d.directions()[1].variance_share);
  EXPECT_LT(d.scaled_condition(), d.raw_condition());
  EXPECT_NE(
      d.directions()[0].description.find("the right centre (x) against the right rotation about y"),
      std::string::npos)
      << d.directions()[0].description;
}

TEST(ScaledDecomposition, NegativeVarianceIsNamed) {
  Covariance c{CovarianceKind::prior, {"left.f_px", "left.ax"}, {}};
  c.matrix.resize(2, 2);
  c.matrix << 1, 2, 2, 1;
  try {
    ScaledDecomposition d(c);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("not positive semi-definite"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("focal length against"), std::string::npos);
  }
}

TEST(ScaledDecomposition, AHeldParameterStaysHeld) {
  Covariance c{CovarianceKind::prior, {"left.f_px", "left.ax"}, Eigen::MatrixXd::Zero(2, 2)};
  c.matrix(0, 0) = 9;
  const ScaledDecomposition d(c);
  EXPECT_EQ(d.factor().row(1).norm(), 0);
  EXPECT_NEAR(d.factor().row(0).norm(), 3, 1e-12);
}

/// The board of every frame seen by one row of its corners alone.
SimulatedBoard rows_of_boards(std::uint64_t seed) {
  SimulatedBoard board = simulate_board(test::stereo_rig(), {}, {.seed = seed, .frames = 1});
  for (BoardView& view : board.observations.views) {
    view.ids.resize(9);
    view.pixels_px.resize(9);
  }
  return board;
}

// A row of corners leaves the board free to turn about it, whatever rounding makes of that.
TEST(NormalEquations, ARowOfCornersFixesNoPose) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SimulatedBoard board = rows_of_boards(seed);
    const std::string expected =
        "frame 0: its corners do not determine the pose of the board; leave the frame out";
    EXPECT_EQ(test::error_message(
                  [&] { reduced_normal_equations(board.observations, board.truth, 0.2); }),
              expected)
        << seed;
    EXPECT_EQ(
        test::error_message([&] { conditional_board_poses(board.observations, board.truth); }),
        expected)
        << seed;
  }
}

// Rank two of four, in units twelve powers of ten apart, one row without variance.
TEST(ScaledRoot, IsARootAndItsPseudoInverse) {
  Eigen::MatrixXd half(4, 2);
  half << 1e3, -2e3, 3e-3, 1e-3, 0, 0, -2e-9, 4e-9;
  const Eigen::MatrixXd A = half * half.transpose();
  const ScaledRoot found(A);
  ASSERT_EQ(found.root.cols(), 2);
  EXPECT_LT((found.white * found.root - Eigen::Matrix2d::Identity()).norm(), 1e-12);
  const Eigen::VectorXd sd = half.rowwise().norm();
  for (const Eigen::Index i : {0, 1, 3}) {
    for (const Eigen::Index k : {0, 1, 3}) {
      EXPECT_NEAR((found.root * found.root.transpose())(i, k) / (sd[i] * sd[k]),
                  A(i, k) / (sd[i] * sd[k]), 1e-12);
    }
  }
  EXPECT_TRUE(found.root.row(2).isZero(0));
}

TEST(ScaledEigen, KeepsTheOrderOfEqualDirections) {
  const Eigen::Vector3d variances(4, 9, 1e-4);
  const ScaledEigen eigen(variances.asDiagonal().toDenseMatrix());
  EXPECT_LT((eigen.directions.cwiseAbs() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_EQ(eigen.deviations, Eigen::Vector3d(2, 3, 1e-2));
}

}  // namespace
}  // namespace vernier
