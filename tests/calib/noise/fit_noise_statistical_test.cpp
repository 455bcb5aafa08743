// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "calib/covariance.h"
#include "calib/noise/fit_corner_noise.h"
#include "calib/noise/noise_of_estimate.h"
#include "calib/rig.h"
#include "calib/rig_difference.h"
#include "tests/support/noisy_board.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr int trials = 30;

RigEstimate simulated(const CornerNoise& noise, std::uint32_t trial) {
  auto drawn = test::noisy_board(
      test::stereo_rig(), {}, {.seed = 6001, .trial = trial, .poses = trial, .frames = 14}, noise);
  return calibrate(drawn.board.observations, {.reject_outliers = false, .check_input = false});
}

// Poses and noise drawn anew in each of 40 trials of 14 frames (12 with a shape). The mean of each
// squared component over the true one is 1 within 3.5 standard errors of that mean and a bias of
// 0.05; all components together raise a false alarm in less than 0.6 % of sets of trials.
TEST(CornerNoise, ComponentsAreRecovered) {
  const CornerNoise truth{.white_px = 0.1,
                          .field_px = 0.08,
                          .field_length_m = 0.06,
                          .motion_rad = 4e-3,
                          .motion_m = 6e-4,
                          .shape_plane_m = 5e-5,
                          .shape_height_m = 2e-4};
  for (const bool shape : {false, true}) {
    CornerNoise there = truth;
    if (!shape) there.shape_plane_m = there.shape_height_m = 0;
    const int trials = shape ? 12 : 40;
    Eigen::ArrayXXd ratios(shape ? 7 : 5, trials);
    for (int t = 0; t < trials; ++t) {
      const RigEstimate estimate = simulated(there, static_cast<std::uint32_t>(t));
      const RestrictedLikelihood likelihood = noise_likelihood(estimate, {.shape = shape});
      const NoiseFit fit = fit_corner_noise(likelihood, 0.025);
      EXPECT_TRUE(fit.converged);
      ratios.col(t) = (2 * (likelihood.logs(fit.noise) - likelihood.logs(truth))).array().exp();
    }
    const char* names[] = {"white", "field", "length", "turn", "move", "plane", "height"};
    for (Eigen::Index k = 0; k < ratios.rows(); ++k) {
      const double mean = ratios.row(k).mean();
      const double sd = std::sqrt((ratios.row(k) - mean).square().sum() / (trials - 1));
      RecordProperty(std::string(names[k]) + (shape ? "_with_shape" : ""),
                     std::to_string(mean) + " sd " + std::to_string(sd));
      EXPECT_LT(std::abs(mean - 1), 3.5 * sd / std::sqrt(trials) + 0.05) << names[k];
      EXPECT_LT(sd, 0.6) << names[k];
    }
  }
}

// White noise alone. The levels are nominal, and hold as upper bounds: 8 or more of 30 at a true
// 5 % occur in 0.02 % of sets of trials.
TEST(CornerNoise, AbsentComponentsAreSeldomFound) {
  int motions = 0, fields = 0, shapes = 0;
  for (int t = 0; t < trials; ++t) {
    const RigEstimate estimate =
        simulated({.white_px = 0.15}, static_cast<std::uint32_t>(1000 + t));
    const CornerNoiseEstimate found = estimate_corner_noise(estimate, {});
    motions += found.motion->p_value < 0.05;
    fields += found.field->p_value < 0.05;
    const auto with_shape = estimate_corner_noise(estimate, {.field = false, .shape = true});
    shapes += with_shape.shape->p_value < 0.05;
    const CornerNoise& noise = found.fit.noise;  // a field of half a square is white noise
    EXPECT_NEAR(std::hypot(noise.white_px, noise.field_px), 0.15, 0.012);
    EXPECT_LT(noise.motion_m, 1.5e-4);
    if (noise.field_length_m > 0.025) {
      EXPECT_LT(noise.field_px, 0.05);
    }
  }
  RecordProperty("false_motions", motions);
  RecordProperty("false_fields", fields);
  RecordProperty("false_shapes", shapes);
  EXPECT_LT(motions, 8);
  EXPECT_LT(fields, 8);
  EXPECT_LT(shapes, 8);
}

// Real ones are: motions of 0.5 mm, a field of half the white noise and heights of 0.2 mm in every
// trial at 1 %.
TEST(CornerNoise, PresentComponentsAreFound) {
  for (std::uint32_t t = 0; t < 8; ++t) {
    const CornerNoise noise{.white_px = 0.1,
                            .field_px = 0.05,
                            .field_length_m = 0.06,
                            .motion_rad = 3e-3,
                            .motion_m = 5e-4,
                            .shape_height_m = t < 4 ? 2e-4 : 0};
    const bool shape = noise.shape_height_m > 0;
    const CornerNoiseEstimate found =
        estimate_corner_noise(simulated(noise, 2000 + t), {.shape = shape});
    EXPECT_LT(found.motion->p_value, 0.01);
    EXPECT_LT(found.field->p_value, 0.01);
    if (shape) {
      EXPECT_LT(found.shape->p_value, 0.01);
    }
  }
}

// The best linear prediction of each frame's motion: its error over what the motions are is below
// one in the mean, and the test of one frame keeps its level where nothing moved (14 x 30 frames at
// 1 %: at most 13 are found in all but 0.02 % of sets) and finds a motion of 0.9 mm across the
// view.
TEST(CornerNoise, MotionsOfFramesAreTold) {
  const CornerNoise noise{.white_px = 0.1, .motion_rad = 1e-3, .motion_m = 3e-4};
  double error2 = 0, motion2 = 0;
  for (std::uint32_t t = 0; t < 10; ++t) {
    auto drawn = test::noisy_board(test::stereo_rig(), {},
                                   {.seed = 6002, .trial = t, .poses = t, .frames = 14}, noise);
    const RigEstimate estimate =
        calibrate(drawn.board.observations, {.reject_outliers = false, .check_input = false});
    const NoiseFit fit = fit_corner_noise(noise_likelihood(estimate, {.field = false}), 0.025);
    ASSERT_EQ(fit.solution.motions.size(), drawn.motions.size());
    for (std::size_t f = 0; f < drawn.motions.size(); ++f) {
      const Eigen::Vector3d truth = drawn.motions[f].tail<3>();
      error2 += (fit.solution.motions[f].predicted.tail<3>() - truth).squaredNorm();
      motion2 += truth.squaredNorm();
      if (truth.head<2>().norm() > 9e-4) {
        EXPECT_GT(fit.solution.motions[f].chi2, 16.8);
      }
    }
  }
  RecordProperty("error_share", std::to_string(error2 / motion2));
  EXPECT_LT(error2 / motion2, 0.7);
  int found = 0;
  for (std::uint32_t t = 0; t < trials; ++t) {
    const RigEstimate estimate = simulated({.white_px = 0.15}, 1000 + t);
    const NoiseFit fit = fit_corner_noise(noise_likelihood(estimate, {.field = false}), 0.025);
    for (const FrameMotion& motion : fit.solution.motions) found += motion.chi2 > 16.812;
  }
  RecordProperty("false_frames", found);
  EXPECT_LE(found, 13);
}

// Boards with a shape that move, white noise: the error of the rig, in the usual calibration's
// standard deviations, and the squared Mahalanobis distance of the truth, over 16 sets of 14 views.
TEST(RandomEffects, RigsAreCloserToTheTruthAndSayHowClose) {
  constexpr int sets = 16;
  const CornerNoise noise{.white_px = 0.1,
                          .motion_rad = 1.3e-3,
                          .motion_m = 3e-4,
                          .shape_plane_m = 5e-5,
                          .shape_height_m = 1.8e-4};
  Eigen::VectorXd usual2 = Eigen::VectorXd::Zero(16), with2 = usual2, variance = usual2;
  double nees = 0;
  for (std::uint32_t t = 0; t < sets; ++t) {
    const auto drawn = test::noisy_board(
        test::stereo_rig(), {}, {.seed = 7001, .trial = t, .poses = t, .frames = 14}, noise);
    const Rig& truth = drawn.board.truth.rig;
    CalibrationOptions how{.reject_outliers = false, .check_input = false};
    const RigEstimate usual = calibrate(drawn.board.observations, how);
    how.board_shape = how.motion = true;
    const RigEstimate with = calibrate(drawn.board.observations, how);
    EXPECT_TRUE(with.calibration->trust_warnings.empty());
    usual2 += difference(truth, usual.rig).cwiseAbs2();
    with2 += difference(truth, with.rig).cwiseAbs2();
    variance += usual.covariance->matrix.diagonal();
    nees += rig_difference(with.rig, *with.covariance, truth,
                           Covariance{with.covariance->kind, with.covariance->names,
                                      Eigen::MatrixXd::Zero(16, 16)})
                .mahalanobis2;
  }
  const double ratio =
      std::sqrt(with2.cwiseQuotient(variance).sum() / usual2.cwiseQuotient(variance).sum());
  RecordProperty("error_ratio", std::to_string(ratio));
  RecordProperty("nees_per_dof", std::to_string(nees / sets / 16));
  EXPECT_LT(ratio, 0.75);
  EXPECT_GT(nees / sets / 16, 0.8);
  EXPECT_LT(nees / sets / 16, 1.2);
}

// From three frames per parameter on the scatter has a say beside the bound of the effects: with a
// smooth error that they do not hold, over 8 sets of 50 views (1.6 by the scatter alone, as
// before).
TEST(RandomEffects, ManyFramesSayHowCloseToo) {
  constexpr int sets = 8;
  const CornerNoise noise{.white_px = 0.1,
                          .field_px = 0.1,
                          .field_length_m = 0.06,
                          .motion_rad = 1.3e-3,
                          .motion_m = 3e-4,
                          .shape_plane_m = 5e-5,
                          .shape_height_m = 1.8e-4};
  double nees = 0;
  for (std::uint32_t t = 0; t < sets; ++t) {
    const auto drawn = test::noisy_board(
        test::stereo_rig(), {}, {.seed = 7201, .trial = t, .poses = t, .frames = 50}, noise);
    CalibrationOptions how{.reject_outliers = false, .check_input = false};
    how.board_shape = how.motion = true;
    const RigEstimate with = calibrate(drawn.board.observations, how);
    EXPECT_EQ(with.covariance->kind, CovarianceKind::clustered);
    const Eigen::VectorXd error = difference(with.rig, drawn.board.truth.rig);
    nees += error.dot(Eigen::LLT<Eigen::MatrixXd>(with.covariance->matrix).solve(error));
  }
  RecordProperty("nees_per_dof", std::to_string(nees / sets / 16));
  EXPECT_GT(nees / sets / 16, 0.6);
  EXPECT_LT(nees / sets / 16, 1.4);
}

}  // namespace
}  // namespace vernier
