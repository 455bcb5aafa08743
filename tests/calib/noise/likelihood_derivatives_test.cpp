// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Value, gradient and information of the restricted likelihood of a ragged calibration: views that
// see different parts of the board, frames that one camera sees.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/estimate/held_parameters.h"
#include "calib/noise/frame_rows.h"
#include "calib/noise/noise_of_estimate.h"
#include "calib/noise/restricted_likelihood.h"
#include "tests/support/board_defects.h"
#include "tests/support/dense_likelihood.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Want = RestrictedLikelihood::Want;

using test::all_parts;

/// The corners from `first` on are not seen, `count` of them.
void hide(BoardView& view, int first, int count) {
  view.ids.erase(view.ids.begin() + first, view.ids.begin() + first + count);
  view.pixels_px.erase(view.pixels_px.begin() + first, view.pixels_px.begin() + first + count);
}

RigEstimate ragged_calibration(const CalibrationOptions& how = {}) {
  const Chessboard board{.columns = 5, .rows = 4, .square_m = 0.05};
  auto drawn = test::noisy_board(test::stereo_rig(), board, {.seed = 812, .frames = 9}, all_parts);
  BoardObservations& seen = drawn.board.observations;
  hide(test::view_of(seen, 1, 0), 0, 5);
  hide(test::view_of(seen, 4, 1), 3, 4);
  hide(test::view_of(seen, 5, 0), 3, 4);
  hide(test::view_of(seen, 6, 0), 12, 8);
  hide(test::view_of(seen, 6, 1), 14, 6);
  std::erase_if(seen.views, [](const BoardView& view) {
    return (view.frame == 2 && view.camera == 1) || (view.frame == 7 && view.camera == 0);
  });
  CalibrationOptions options = how;
  options.reject_outliers = options.check_input = false;
  return calibrate(seen, options);
}

std::vector<FrameRows> rows_of(const RigEstimate& estimate) {
  const auto& evidence = *estimate.evidence;
  return frame_rows(evidence.observations,
                    {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m},
                    free_directions(estimate.rig, held_parameters(estimate)));
}

test::DenseLikelihood dense(const RigEstimate& estimate) {
  return {rows_of(estimate), estimate.evidence->observations.target_m};
}

/// Every choice of parts.
std::vector<NoiseParts> choices() {
  std::vector<NoiseParts> all;
  for (int k = 0; k < 8; ++k) {
    all.push_back({(k & 1) != 0, (k & 2) != 0, (k & 4) != 0});
    if (all.back().motion) all.push_back({(k & 1) != 0, true, (k & 4) != 0, true});
  }
  return all;
}

/// Zero for what is not there.
CornerNoise only(const NoiseParts& parts) {
  CornerNoise noise = all_parts;
  if (!parts.field) noise.field_px = 0;
  if (!parts.motion) noise.motion_rad = noise.motion_m = 0;
  if (parts.baseline_motion) noise.motion_baseline_m = 7e-4;
  if (!parts.shape) noise.shape_plane_m = noise.shape_height_m = 0;
  return noise;
}

TEST(LikelihoodOfRaggedViews, IsThatOfDenseMatrices) {
  const RigEstimate estimate = ragged_calibration();
  const auto oracle = dense(estimate);
  for (const NoiseParts& parts : choices()) {
    const RestrictedLikelihood likelihood = noise_likelihood(estimate, parts);
    EXPECT_EQ(likelihood.coordinates(), oracle.residuals_px().size());
    EXPECT_NEAR(likelihood.at(only(parts), Want::gradient).minus_two_log,
                oracle.minus_two_log(only(parts)), 1e-5);
  }
}

TEST(LikelihoodOfRaggedViews, HasTheGradientOfDifferences) {
  for (const CalibrationOptions& how :
       {CalibrationOptions{}, CalibrationOptions{.held = {{"left.ax", 1.002}}},
        CalibrationOptions{.known = {{"right.tx_m", -0.2, 1e-4}}}}) {
    const RigEstimate estimate = ragged_calibration(how);
    for (const NoiseParts& parts : choices()) {
      const RestrictedLikelihood likelihood = noise_likelihood(estimate, parts);
      const VectorXd logs = likelihood.logs(only(parts));
      const VectorXd gradient = likelihood.at(only(parts), Want::gradient).gradient;
      ASSERT_EQ(gradient.size(), logs.size());
      for (Index k = 0; k < logs.size(); ++k) {
        constexpr double h = 1e-4;
        const auto value = [&](double step) {
          VectorXd moved = logs;
          moved[k] += step;
          return likelihood.at(likelihood.noise(moved), Want::step).minus_two_log;
        };
        const double numeric = (value(h) - value(-h)) / (2 * h);
        EXPECT_NEAR(gradient[k], numeric, 1e-5 * std::max(10.0, std::abs(numeric))) << k;
      }
    }
  }
}

// I_ij = q_iᵀ P q_j, q_i = ∂V/∂θ_i P r, with dense matrices and V differentiated by differences.
TEST(LikelihoodOfRaggedViews, HasTheAverageInformationOfDenseMatrices) {
  const RigEstimate estimate = ragged_calibration();
  const auto oracle = dense(estimate);
  for (const NoiseParts& parts : choices()) {
    const RestrictedLikelihood likelihood = noise_likelihood(estimate, parts);
    const VectorXd logs = likelihood.logs(only(parts));
    const MatrixXd P = oracle.P(only(parts));
    const VectorXd Pr = P * oracle.residuals_px();
    MatrixXd q(Pr.size(), logs.size());
    for (Index k = 0; k < logs.size(); ++k) {
      const auto V = [&](double step) {
        VectorXd moved = logs;
        moved[k] += step;
        return oracle.V(likelihood.noise(moved));
      };
      q.col(k) = (V(1e-4) - V(-1e-4)) * Pr / 2e-4;
    }
    const MatrixXd expected = q.transpose() * P * q;
    const MatrixXd found = likelihood.at(only(parts), Want::gradient).information;
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-5 * expected.cwiseAbs().maxCoeff());
  }
}

// The columns of M are along the baseline and across it: the variance along it is that of a motion
// of the board in this direction, whatever the axes of the cameras, and equal ones are no new
// model.
TEST(LikelihoodOfRaggedViews, HasAMotionAlongTheBaseline) {
  const RigEstimate estimate = ragged_calibration();
  const Eigen::Matrix3d axes = motion_axes(estimate.rig, 1);
  const Pose& T = estimate.rig.T_camera_first[1];
  EXPECT_LT((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((T * Eigen::Vector3d(T.t.norm() * axes.col(0))).norm(), 1e-12);  // its centre
  for (const FrameRows& frame : rows_of(estimate)) {
    if (frame.views.size() < 2) continue;
    const MatrixXd along = frame.by_pose.rightCols<3>() * axes.col(0);
    const Index first = frame.views[1].first;
    const Index rows = along.rows() - first;
    EXPECT_LT((frame.by_motion.col(3) - along).tail(rows).norm(), 1e-9 * along.norm());
    EXPECT_TRUE(frame.by_motion.col(3).head(first).isZero(0));
  }
  CornerNoise equal = test::all_parts;
  const double isotropic = noise_likelihood(estimate, {}).at(equal, Want::step).minus_two_log;
  equal.motion_baseline_m = equal.motion_m;
  EXPECT_DOUBLE_EQ(
      noise_likelihood(estimate, {.baseline_motion = true}).at(equal, Want::step).minus_two_log,
      isotropic);
}

// û = −Σ Mᵀ P r and its test against none: β = −G⁻¹ Mᵀ P r has the covariance G⁻¹ − Σ, G = Mᵀ P M.
TEST(LikelihoodOfRaggedViews, HasTheMotionsOfDenseMatrices) {
  const RigEstimate estimate = ragged_calibration();
  const auto oracle = dense(estimate);
  const MatrixXd P = oracle.P(all_parts);
  VectorXd s(6);
  s << VectorXd::Constant(3, all_parts.motion_rad), VectorXd::Constant(3, all_parts.motion_m);
  const auto motions =
      noise_likelihood(estimate, {.shape = true}).at(all_parts, Want::solution).motions;
  ASSERT_EQ(motions.size(), 7U);  // two of nine frames are one camera's
  for (const FrameMotion& motion : motions) {
    const MatrixXd M = oracle.by_motion(static_cast<std::size_t>(motion.frame));
    const VectorXd h = M.transpose() * P * oracle.residuals_px();
    VectorXd predicted = -s.cwiseAbs2().cwiseProduct(h);
    predicted.tail<3>() = (motion_axes(estimate.rig, 1) * predicted.tail<3>()).eval();
    EXPECT_LT((motion.predicted - predicted).cwiseQuotient(s).norm(), 1e-6);
    const MatrixXd G = M.transpose() * P * M;
    const MatrixXd scaled = s.asDiagonal() * G * s.asDiagonal();  // of β / s
    const MatrixXd covariance = test::inverse(scaled);
    const VectorXd beta = covariance * s.cwiseProduct(h);
    const MatrixXd C = covariance - MatrixXd::Identity(6, 6);
    const double chi2 = beta.dot(test::inverse(C) * beta);
    EXPECT_NEAR(motion.chi2, chi2, 1e-5 * chi2);
  }
}

// Linearised at a shape that the residuals contain, as at none.
TEST(LikelihoodOfRaggedViews, IsTheSameAtAnyShape) {
  const RigEstimate estimate = ragged_calibration();
  const auto& target_m = estimate.evidence->observations.target_m;
  std::vector<FrameRows> rows = rows_of(estimate);
  const NoiseParts parts{.shape = true};
  const NoiseSolution flat =
      RestrictedLikelihood(rows, target_m, parts).at(all_parts, Want::solution);
  VectorXd shape_m(3 * static_cast<Index>(target_m.size()));
  for (Index i = 0; i < shape_m.size(); ++i) {
    shape_m[i] = 1e-4 * std::sin(static_cast<double>(i));
  }
  for (FrameRows& frame : rows) {
    for (const ViewRows& view : frame.views) {
      const auto n = static_cast<Index>(view.ids.size());
      for (Index i = 0; i < 2 * n; ++i) {
        const Index at = 3 * view.ids[static_cast<std::size_t>(i % n)];
        frame.residual_px[view.first + i] +=
            frame.by_point.row(view.first + i).dot(shape_m.segment<3>(at));
      }
    }
  }
  const NoiseSolution uneven =
      RestrictedLikelihood(rows, target_m, parts, {}, shape_m).at(all_parts, Want::solution);
  EXPECT_NEAR(uneven.minus_two_log, flat.minus_two_log, 1e-6);
  EXPECT_LT((uneven.gradient - flat.gradient).norm(), 1e-6);
  EXPECT_LT((uneven.information - flat.information).norm(), 1e-6 * flat.information.norm());
  EXPECT_LT((uneven.step.tail(shape_m.size()) + shape_m - flat.step.tail(shape_m.size())).norm(),
            1e-9);
}

// The frames' terms and the prior are the information; only a solution holds them.
TEST(LikelihoodOfRaggedViews, AddsUpFromItsFrames) {
  const RigEstimate estimate = ragged_calibration();
  const RestrictedLikelihood likelihood = noise_likelihood(estimate, {.shape = true});
  const auto equations = likelihood.at(all_parts, Want::solution).equations;
  ASSERT_EQ(equations.frame_information.size(), 9U);
  MatrixXd sum = equations.prior_information;
  for (const MatrixXd& of_frame : equations.frame_information) sum += of_frame;
  const VectorXd scale = equations.information.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd apart = scale.asDiagonal() * (sum - equations.information) * scale.asDiagonal();
  EXPECT_LT(apart.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_TRUE(likelihood.at(all_parts, Want::gradient).equations.frame_information.empty());
}

}  // namespace
}  // namespace vernier
