// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibrate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "calib/base/decompositions.h"
#include "calib/board_observations.h"
#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/simulated_board.h"
#include "tests/support/error_message.h"
#include "tests/support/scenes.h"

namespace vernier {
namespace {

class ExactViews : public testing::TestWithParam<const char*> {};

TEST_P(ExactViews, GiveTheTrueRigBack) {
  const Rig truth = test::stereo_rig(camera_model(GetParam()));
  const SimulatedBoard board =
      simulate_board(truth, {}, {.seed = 4, .frames = 20, .pixel_sigma_px = 0});
  const RigEstimate estimate =
      calibrate(board.observations, {.model = camera_model(GetParam()), .pixel_sigma_px = 1e-3});
  const Eigen::VectorXd sd = estimate.covariance_mvb->diagonal().cwiseSqrt();
  const Eigen::VectorXd miss = difference(estimate.rig, truth).cwiseQuotient(sd);
  EXPECT_LT(miss.cwiseAbs().maxCoeff(), 1e-3) << miss.transpose();
  EXPECT_LT(estimate.calibration->rms_px, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Models,
                         ExactViews,
                         testing::Values("pinhole", "radial1", "opencv4", "opencv5"));

TEST(Calibrate, IsTheSameToTheBitTwice) {
  const auto observations = simulate_board(test::stereo_rig(), {}, {.seed = 4}).observations;
  EXPECT_EQ(parameters(calibrate(observations).rig), parameters(calibrate(observations).rig));
}

TEST(Calibrate, OneCameraAndThreeCameras) {
  Rig rig = test::stereo_rig();
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[2].name = "camera2";
  rig.T_camera_first.push_back({rotation_from_vector({0, 0.05, 0}), {0.15, 0, 0}});
  const SimulatedBoard three = simulate_board(rig, {}, {.seed = 6, .pixel_sigma_px = 0});
  EXPECT_LT(difference(calibrate(three.observations).rig, rig).norm(), 1e-5);

  BoardObservations one = three.observations;
  std::erase_if(one.views, [](const BoardView& view) { return view.camera > 0; });
  one.size_px.resize(1);
  const RigEstimate single = calibrate(one);
  EXPECT_EQ(single.covariance->matrix.rows(), 5);
  EXPECT_NEAR(single.rig.cameras[0].f_px(), 525, 1e-5);
}

TEST(Calibrate, ManyFramesGetTheClusteredCovariance) {
  const auto board = simulate_board(test::stereo_rig(), {6, 5, 0.04}, {.seed = 6, .frames = 60});
  const RigEstimate estimate = calibrate(board.observations);
  EXPECT_EQ(estimate.covariance->kind, CovarianceKind::clustered);
  const Eigen::ArrayXd ratio =
      estimate.covariance->matrix.diagonal().array() / estimate.covariance_mvb->diagonal().array();
  EXPECT_GT(ratio.minCoeff(), 1 - 1e-9);  // white noise
  EXPECT_LT(ratio.maxCoeff(), 1.7);
}

TEST(Calibrate, FewFramesGetTheSameByAnotherName) {
  const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 6, .frames = 13});
  const RigEstimate estimate = calibrate(board.observations);
  EXPECT_EQ(estimate.covariance->kind, CovarianceKind::jackknife);
  const Eigen::ArrayXd ratio =
      estimate.covariance->matrix.diagonal().array() / estimate.covariance_mvb->diagonal().array();
  EXPECT_GT(ratio.minCoeff(), 1 - 1e-9);  // white noise
  EXPECT_LT(ratio.maxCoeff(), 1.7);
  EXPECT_EQ(calibrate(board.observations, {.white_noise = true}).covariance->kind,
            CovarianceKind::mvb);
}

TEST(Calibrate, TheCovarianceIsNowhereBelowTheBound) {
  for (const int frames : {3, 5, 8, 60}) {
    for (const bool known : {false, true}) {
      CalibrationOptions options;
      if (known) options.known = {{"left.f_px", 510, 5}, {"right.k1", 0, 0.01}};
      const auto board = simulate_board(test::stereo_rig(), {}, {.seed = 19, .frames = frames});
      const RigEstimate estimate = calibrate(board.observations, options);
      ASSERT_NE(estimate.covariance->kind, CovarianceKind::mvb);
      const vernier::internal::Cholesky bound(*estimate.covariance_mvb);
      const Eigen::MatrixXd half = bound.solve_lower(estimate.covariance->matrix).transpose();
      const Eigen::VectorXd ratios =
          vernier::internal::symmetric_eigenvalues(bound.solve_lower(half));
      EXPECT_GT(ratios.minCoeff(), 1 - 1e-6) << frames << known;
    }
  }
}

TEST(Calibrate, TwoViewsAreTooFew) {
  auto observations = simulate_board(test::stereo_rig(), {}, {.seed = 4}).observations;
  std::erase_if(observations.views, [](const BoardView& view) { return view.frame > 1; });
  try {
    calibrate(observations);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("2 views of the board"), std::string::npos);
  }
}

TEST(Calibrate, CamerasWithoutACommonFrameAreNamed) {
  auto observations = simulate_board(test::stereo_rig(), {}, {.seed = 4}).observations;
  std::erase_if(observations.views,
                [](const BoardView& view) { return (view.frame < 10) != (view.camera == 0); });
  try {
    calibrate(observations);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("camera 1: it shares no frame"), std::string::npos);
  }
}

TEST(Calibrate, WhatWasSeenBeforeItFailedIsPartOfTheFault) {
  BoardObservations observations =
      simulate_board(test::stereo_rig(), {},
                     {.seed = 3, .frames = 6, .pixel_sigma_px = 0, .tilt_rad = 0})
          .observations;
  for (Eigen::Vector3d& point : observations.target_m) point *= 1000;
  const auto [place, fault, remedy] = test::error_parts([&] {
    // What is held keeps the tilts from being looked at.
    calibrate(observations, {.held = {{"left.k1", 0.0}}});
  });
  EXPECT_EQ(place.find(": "), std::string::npos) << place;
  EXPECT_NE(fault.find("perhaps because of what was seen before: the board measures"),
            std::string::npos)
      << fault;
  EXPECT_EQ(remedy.find("the board measures"), std::string::npos);
  EXPECT_NE(remedy, "");
}

TEST(Calibrate, NumbersOutOfRangeAreRefused) {
  const auto observations = simulate_board(test::stereo_rig(), {}, {.seed = 4}).observations;
  const auto complaint = [&](const CalibrationOptions& options) {
    return test::error_message([&] { calibrate(observations, options); });
  };
  for (const double sigma : {-1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_NE(complaint({.pixel_sigma_px = sigma}).find("calibration: pixel noise of"),
              std::string::npos);
  }
  for (const int iterations : {0, -5}) {
    EXPECT_EQ(complaint({.max_iterations = iterations}),
              "calibration: " + std::to_string(iterations) + " iterations; give 1 or more");
  }
}

}  // namespace
}  // namespace vernier
