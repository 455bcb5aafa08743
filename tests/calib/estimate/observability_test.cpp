// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/observability.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "calib/base/decompositions.h"
#include "calib/camera.h"
#include "calib/data_and_prior.h"
#include "calib/estimate/simulated_pairs.h"
#include "calib/pair_observations.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/solver/packed_pairs.h"
#include "tests/support/dense_oracles.h"
#include "tests/support/pair_priors.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// The plane of `pairs` without noise, n·X = 1, from three triangulated corners.
Eigen::Vector3d plane_of(const PairObservations& pairs, const Rig& rig) {
  Eigen::Matrix3d X;
  const Pose& T = rig.T_camera_first[1];
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector4d& y = pairs.pixels_px[static_cast<std::size_t>(i * 31)];
    const Eigen::Vector3d l = unproject(rig.cameras[0], y.head<2>());
    const Eigen::Vector3d r = T.R.transpose() * unproject(rig.cameras[1], y.tail<2>());
    Eigen::Matrix<double, 3, 2> A;
    A << l, -r;
    const Eigen::Vector3d b = -(T.R.transpose() * T.t);
    const Eigen::Vector2d depth = test::least_squares(A, b);
    X.row(i) = l * depth[0];
  }
  return test::least_squares(X, Eigen::Vector3d::Ones());
}

/// Directions without information, by the analytic vectors, and whether the rest has some.
void expect_rank(const Rig& rig,
                 const PairObservations& pairs,
                 const Eigen::MatrixXd& unseen,
                 int rank) {
  ASSERT_EQ(unseen.cols(), 16 - rank);
  const Eigen::VectorXd sd = test::datasheet_sd();
  const Eigen::MatrixXd S =
      sd.asDiagonal() * epipolar_sums(PackedPairs(pairs), rig, {}).information * sd.asDiagonal();
  const Eigen::MatrixXd N = sd.cwiseInverse().asDiagonal() * unseen;
  const Eigen::MatrixXd Q = test::full_q(N);
  const Eigen::MatrixXd null = Q.leftCols(unseen.cols()), rest = Q.rightCols(rank);
  const double largest = S.norm();
  EXPECT_LT((null.transpose() * S * null).norm(), 1e-13 * largest);
  EXPECT_LT((S * null).norm(), 1e-9 * largest);
  EXPECT_GT(symmetric_eigenvalues(rest.transpose() * S * rest)[0], 1e-11 * largest);
}

TEST(Observability, PairsSeeFifteenOfSixteen) {
  const Rig rig = test::stereo_rig();
  const PairObservations pairs = simulate_pairs(rig, 1, 0, {.pixel_sigma_px = 0});
  const Eigen::MatrixXd unseen = unobservable_directions(rig);
  expect_rank(rig, pairs, unseen, 15);
  const Eigen::Vector3d T = rig.T_camera_first[1].t;
  EXPECT_NEAR(std::abs(unseen.col(0).tail<3>().normalized().dot(T.normalized())), 1, 1e-12);
  EXPECT_LT(unseen.col(0).head<13>().norm(), 1e-12 * unseen.norm());
}

TEST(Observability, PairsSeeNineWithoutDistortion) {
  Rig rig = test::stereo_rig();
  for (Camera& camera : rig.cameras) camera.parameters[4] = 0;
  const PairObservations pairs = simulate_pairs(rig, 2, 0, {.pixel_sigma_px = 0});
  expect_rank(rig, pairs, unobservable_directions(rig), 9);
}

TEST(Observability, PairsSeeTwelveWithOneLensUndistorted) {
  Rig rig = test::stereo_rig();
  rig.cameras[0].parameters[4] = 0;
  const PairObservations pairs = simulate_pairs(rig, 3, 0, {.pixel_sigma_px = 0});
  expect_rank(rig, pairs, unobservable_directions(rig), 12);
}

TEST(Observability, PairsSeeThirteenOnAPlane) {
  const Rig rig = test::stereo_rig();
  const PairObservations pairs =
      simulate_pairs(rig, 4, 0, {.scene = SimulatedScene::plane, .pixel_sigma_px = 0});
  expect_rank(rig, pairs, unobservable_directions(rig, plane_of(pairs, rig)), 13);
}

TEST(Observability, AnotherLensAtAnotherScaleIsTheSameLens) {
  // The same change in every coefficient that a lens of more terms has.
  for (const char* name : {"opencv4", "opencv5", "opencv8"}) {
    const Rig rig = test::stereo_rig(camera_model(name));
    const PairObservations pairs =
        simulate_pairs(rig, 5, 0, {.scene = SimulatedScene::plane, .pixel_sigma_px = 0});
    const Eigen::MatrixXd unseen = unobservable_directions(rig, plane_of(pairs, rig));
    ASSERT_EQ(unseen.cols(), 3) << name;
    const Eigen::MatrixXd S = epipolar_sums(PackedPairs(pairs), rig, {}).information;
    const Eigen::VectorXd d = S.diagonal().cwiseSqrt();
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT((d.cwiseInverse().asDiagonal() * S * unseen.col(i)).norm(),
                1e-7 * d.cwiseProduct(unseen.col(i)).norm())
          << name;
    }
  }
}

TEST(Observability, WhatPairsCannotSeeStaysThePriors) {
  const Rig rig = test::stereo_rig();
  const PairObservations pairs = simulate_pairs(rig, 6);
  const Eigen::VectorXd sd = test::datasheet_sd();
  const Eigen::MatrixXd before = sd.cwiseAbs2().asDiagonal();
  const Eigen::MatrixXd S = epipolar_sums(PackedPairs(pairs), rig, {}).information;
  const Eigen::MatrixXd P = test::inverse(before);
  const Eigen::MatrixXd after = test::inverse(P + S);
  const Observability o = observability(rig, parameter_names(rig), before, after);
  EXPECT_NEAR(o.scale_information_ratio, 1, 1e-6);
  EXPECT_NEAR(o.baseline_sd_after_m / o.baseline_sd_before_m, 1, 1e-3);
  EXPECT_NEAR(o.from_data, 16 - (P * after).trace(), 1e-8);
  EXPECT_EQ(o.directions.size(), 16u);
  EXPECT_LT(o.directions[0].sd_ratio, 0.02);
  EXPECT_GT(o.directions[15].sd_ratio, 0.99);
  EXPECT_GE(o.unchanged, 1);
  EXPECT_GT(o.improved, 5);
}

}  // namespace
}  // namespace vernier
