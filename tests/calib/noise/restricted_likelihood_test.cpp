// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/noise/restricted_likelihood.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/noise/noise_of_estimate.h"
#include "tests/support/board_defects.h"
#include "tests/support/dense_likelihood.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using test::all_parts;

/// Eight views of a small board, one of which lacks corners in one camera.
RigEstimate small_calibration(const CalibrationOptions& how = {}) {
  const Chessboard board{.columns = 5, .rows = 4, .square_m = 0.05};
  auto drawn = test::noisy_board(test::stereo_rig(), board, {.seed = 811, .frames = 8}, all_parts);
  BoardView& partial = test::view_of(drawn.board.observations, 4, 1);
  for (int k = 0; k < 4; ++k) {
    partial.ids.erase(partial.ids.begin() + 3);
    partial.pixels_px.erase(partial.pixels_px.begin() + 3);
  }
  CalibrationOptions options = how;
  options.reject_outliers = options.check_input = false;
  return calibrate(drawn.board.observations, options);
}

double dense_minus_two_log(const RigEstimate& estimate, CornerNoise noise, bool shape) {
  if (!shape) noise.shape_plane_m = noise.shape_height_m = 0;
  const auto& evidence = *estimate.evidence;
  const BoardState state{estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
  const MatrixXd free = free_directions(estimate.rig, held_parameters(estimate));
  return test::DenseLikelihood(frame_rows(evidence.observations, state, free),
                               evidence.observations.target_m)
      .minus_two_log(noise);
}

TEST(RestrictedLikelihood, IsThatOfDenseMatrices) {
  const RigEstimate estimate = small_calibration();
  for (const bool shape : {false, true}) {
    const RestrictedLikelihood likelihood = noise_likelihood(estimate, {.shape = shape});
    CornerNoise other = all_parts;
    other.white_px = 0.2;
    other.field_length_m = 0.12;
    other.motion_m = 1e-3;
    const auto fast = [&](const CornerNoise& noise) {
      return likelihood.at(noise, RestrictedLikelihood::Want::gradient).minus_two_log;
    };
    for (const CornerNoise& noise : {all_parts, other}) {
      EXPECT_NEAR(fast(noise), dense_minus_two_log(estimate, noise, shape), 1e-5);
    }
  }
}

// So that the ratio of the two tests whether there is a shape.
TEST(RestrictedLikelihood, OfNoShapeIsThatWithoutOne) {
  const RigEstimate estimate = small_calibration();
  const auto at = [&](bool shape, double shape_m) {
    CornerNoise noise = all_parts;
    noise.shape_plane_m = noise.shape_height_m = shape_m;
    return noise_likelihood(estimate, {.shape = shape})
        .at(noise, RestrictedLikelihood::Want::gradient)
        .minus_two_log;
  };
  EXPECT_NEAR(at(true, 1e-9), at(false, 0), 1e-4);
}

TEST(RestrictedLikelihood, ItsGradientIsThatOfDifferences) {
  const RigEstimate estimate = small_calibration();
  for (const bool shape : {false, true}) {
    const RestrictedLikelihood likelihood = noise_likelihood(estimate, {.shape = shape});
    const VectorXd logs = likelihood.logs(all_parts);
    const VectorXd gradient =
        likelihood.at(all_parts, RestrictedLikelihood::Want::gradient).gradient;
    ASSERT_EQ(gradient.size(), shape ? 7 : 5);
    for (Index k = 0; k < logs.size(); ++k) {
      constexpr double h = 1e-4;
      const auto value = [&](double step) {
        VectorXd moved = logs;
        moved[k] += step;
        return likelihood.at(likelihood.noise(moved), RestrictedLikelihood::Want::gradient)
            .minus_two_log;
      };
      const double numeric = (value(h) - value(-h)) / (2 * h);
      EXPECT_NEAR(gradient[k], numeric, 1e-4 * std::max(1.0, std::abs(numeric))) << k;
    }
  }
}

// Of white noise alone, S is the information of calib/solver/normal_equations.h and the estimate
// already the minimum.
TEST(RestrictedLikelihood, OfWhiteNoiseIsTheUsualCalibration) {
  const RigEstimate estimate = small_calibration();
  const RestrictedLikelihood likelihood =
      noise_likelihood(estimate, {.field = false, .motion = false});
  const CornerNoise white{.white_px = estimate.calibration->pixel_sigma_px};
  const NoiseSolution s = likelihood.at(white, RestrictedLikelihood::Want::solution);
  const VectorXd sd = estimate.covariance_mvb->diagonal().cwiseSqrt();
  EXPECT_LT(s.step.cwiseQuotient(sd).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_NEAR(s.gradient[0], 0, 1e-6);  // σ is where the likelihood is greatest
  const MatrixXd identity = s.equations.information * *estimate.covariance_mvb;
  EXPECT_LT((sd.cwiseInverse().asDiagonal() * identity.transpose() * sd.asDiagonal() -
             MatrixXd::Identity(sd.size(), sd.size()))
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
}

TEST(RestrictedLikelihood, CountsWhatIsHeldAndKnown) {
  const RigEstimate held = small_calibration({.held = {{"left.ax", 1.002}}});
  EXPECT_EQ(noise_likelihood(held, {}).rig_directions(), 15);
  EXPECT_NEAR(
      noise_likelihood(held, {}).at(all_parts, RestrictedLikelihood::Want::gradient).minus_two_log,
      dense_minus_two_log(held, all_parts, false), 1e-5);
  const RigEstimate known = small_calibration({.known = {{"right.tx_m", -0.2, 1e-5}}});
  const NoiseSolution s = noise_likelihood(known, {.field = false, .motion = false})
                              .at({.white_px = known.calibration->pixel_sigma_px},
                                  RestrictedLikelihood::Want::solution);
  const VectorXd sd = known.covariance_mvb->diagonal().cwiseSqrt();
  EXPECT_LT(s.step.cwiseQuotient(sd).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(RestrictedLikelihood, RefusesARigWithoutEvidence) {
  RigEstimate estimate = small_calibration();
  estimate.evidence.reset();
  EXPECT_THROW(noise_likelihood(estimate, {}), Error);
  EXPECT_THROW(point_spacing_m({}), Error);
  EXPECT_THROW(point_spacing_m({{0, 0, 0}, {0, 0, 0}}), Error);
  EXPECT_NEAR(point_spacing_m({{0, 0, 0}, {0.03, 0, 0}, {0, 0.02, 0}}), 0.02, 1e-12);
}

}  // namespace
}  // namespace vernier
