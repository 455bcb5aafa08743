// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/estimate/rig_part.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/covariance.h"
#include "calib/pose.h"
#include "calib/projection_uncertainty.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/sampler.h"
#include "calib/statistics/random.h"
#include "calib/triangulation.h"
#include "calib/triangulation_uncertainty.h"
#include "tests/support/error_message.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/relative_difference.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;

namespace {

/// Four cameras that look about the same way, none aligned with another.
Rig four_cameras(const CameraModel& model = Radial1{}) {
  Rig rig = test::stereo_rig(model);
  for (int i = 2; i < 4; ++i) {
    rig.cameras.push_back(rig.cameras[1]);
    rig.cameras.back().name = "camera" + std::to_string(i);
    rig.cameras.back().parameters[0] *= 1 + 0.1 * i;
    rig.T_camera_first.push_back(
        {rotation_from_vector({0.03 * i, -0.08 * i, 0.2 * i}), {-0.1 * i, 0.07, 0.02 * i}});
  }
  return rig;
}

/// A covariance of full rank with the deviations of a calibration, correlated.
Covariance full_covariance_of(const Rig& rig) {
  const std::vector<std::string> names = parameter_names(rig);
  const auto n = static_cast<int>(names.size());
  RandomStream random({.seed = 11});
  Eigen::MatrixXd root(n, n);
  for (int i = 0; i < n; ++i) {
    const bool px = names[static_cast<std::size_t>(i)].ends_with("_px");
    root.row(i) = (px ? 0.2 : 2e-4) * random.normals(n).transpose();
  }
  return {CovarianceKind::clustered, names, root * root.transpose()};
}

RigEstimate calibrated(const Rig& rig) {
  RigEstimate estimate;
  estimate.rig = rig;
  estimate.covariance = full_covariance_of(rig);
  estimate.covariance_mvb = 0.5 * estimate.covariance->matrix;
  estimate.calibration = CalibrationSummary{
      .pixel_sigma_px = 0.2, .rms_px = 0.21, .chi2 = 1234, .dof = 1200, .views = 30};
  return estimate;
}

const std::vector<std::vector<int>> parts{{0, 1}, {0, 3}, {1, 0},    {1, 2},      {3, 1},
                                          {2},    {0},    {2, 0, 3}, {3, 2, 1, 0}};

TEST(RigPart, DerivativeIsThatOfTheComposition) {
  for (const CameraModel& model : {CameraModel(Radial1{}), CameraModel(Fisheye4{})}) {
    const Rig rig = four_cameras(model);
    for (const std::vector<int>& kept : parts) {
      const Rig part = part_of(rig, kept);
      const Eigen::MatrixXd expected = test::numeric_jacobian(
          [&](const Eigen::VectorXd& d) {
            return difference(part_of(retract(rig, d), kept), part);
          },
          Eigen::VectorXd::Zero(parameter_count(rig)));
      EXPECT_LT((part_by_rig(rig, kept) - expected).cwiseAbs().maxCoeff(), 1e-8)
          << testing::PrintToString(kept);
    }
  }
}

TEST(RigPart, PosesAreThoseOfTheRig) {
  const Rig rig = four_cameras();
  const Rig part = part_of(rig, {3, 1});
  const Eigen::Vector3d x(0.2, -0.1, 2);
  EXPECT_EQ(part.cameras[0].name, "camera3");
  EXPECT_LT(
      (part.T_camera_first[1] * (rig.T_camera_first[3] * x) - rig.T_camera_first[1] * x).norm(),
      1e-14);
}

TEST(RigPart, CovarianceIsThatOfSamplesTransformedOneByOne) {
  const RigEstimate whole = calibrated(four_cameras());
  constexpr int count = 20000;
  for (const std::vector<int>& kept : {std::vector{1, 2}, {2, 0}}) {
    const RigEstimate part = part_of(whole, kept);
    const Eigen::MatrixXd& C = part.covariance->matrix;
    const RigSampler sampler(whole, "rig");
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(C.rows(), C.cols());
    for (int i = 0; i < count; ++i) {
      const Eigen::VectorXd d =
          difference(part_of(sampler.sample(1, 7, static_cast<std::uint32_t>(i)), kept), part.rig);
      sum += d * d.transpose();
    }
    for (Eigen::Index i = 0; i < C.rows(); ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        const double sd = std::sqrt((C(i, i) * C(j, j) + C(i, j) * C(i, j)) / count);
        EXPECT_NEAR(sum(i, j) / count, C(i, j), 4.5 * sd) << i << ", " << j;
      }
    }
  }
}

TEST(RigPart, WithTheReferenceCameraIsASubBlock) {
  const RigEstimate whole = calibrated(four_cameras());
  const RigEstimate part = part_of(whole, {0, 2});
  const std::vector<std::string> all = parameter_names(whole.rig);
  const std::vector<std::string>& names = part.covariance->names;
  EXPECT_EQ(names, parameter_names(part.rig));
  std::vector<Eigen::Index> rows;
  for (const std::string& name : names) {
    rows.push_back(std::find(all.begin(), all.end(), name) - all.begin());
  }
  EXPECT_EQ(part.covariance->matrix, whole.covariance->matrix(rows, rows));
  EXPECT_EQ(*part.covariance_mvb, (*whole.covariance_mvb)(rows, rows));
}

TEST(RigPart, StatesOfAPointWhatTheWholeRigStates) {
  const RigEstimate whole = calibrated(four_cameras());
  const Rig& rig = whole.rig;
  const Eigen::MatrixXd& C = whole.covariance->matrix;
  for (const std::vector<int>& kept : {std::vector{0, 2}, {1, 2}, {3, 0}}) {
    const auto a = static_cast<std::size_t>(kept[0]), b = static_cast<std::size_t>(kept[1]);
    const RigEstimate pair = part_of(whole, kept);
    const Eigen::MatrixXd& own = pair.covariance->matrix;
    const Eigen::Vector3d x = rig.T_camera_first[a] * Eigen::Vector3d(0.2, 0.1, 3);
    const auto derivative = [&](auto value) {
      return test::numeric_jacobian(
          [&](const Eigen::VectorXd& d) -> Eigen::VectorXd { return value(retract(rig, d)); },
          Eigen::VectorXd::Zero(parameter_count(rig)));
    };
    const auto T_b_a = [&](const Rig& r) {
      return r.T_camera_first[b] * r.T_camera_first[a].inverse();
    };
    const Eigen::MatrixXd projected =
        derivative([&](const Rig& r) { return project(r.cameras[b], T_b_a(r) * x); });
    const Eigen::Matrix2d stated =
        ProjectionUncertainty(pair.rig, own, 1, PointFixedTo::first_camera)
            .covariance_of_point(T_b_a(rig) * x);
    EXPECT_LT(test::relative_difference(stated, projected * C * projected.transpose()), 1e-6);

    const PixelPair pixels{project(rig.cameras[a], x), project(rig.cameras[b], T_b_a(rig) * x)};
    const Eigen::MatrixXd point = derivative([&](const Rig& r) {
      return *triangulate_point({{r.cameras[a], r.cameras[b]}, {Pose{}, T_b_a(r)}}, pixels);
    });
    const auto triangulated = TriangulationUncertainty(pair.rig, own).at(pixels, 0.1);
    ASSERT_TRUE(triangulated);
    EXPECT_LT(test::relative_difference(triangulated->calibration, point * C * point.transpose()),
              1e-6);
  }
}

TEST(RigPart, KeepsTheSummaryButForWhatThePartHasNot) {
  RigEstimate whole = calibrated(four_cameras());
  whole.calibration->held = {"camera2.ax", "camera3.k1", "camera2.tx_m"};
  whole.calibration->outliers = {{.frame = 1, .camera = 0}, {.frame = 2, .camera = 2}};
  whole.evidence = CalibrationEvidence{};
  whole.other_keys = R"({"made":"here"})";
  const RigEstimate same_frame = part_of(whole, {0, 2}), other = part_of(whole, {1, 2});
  EXPECT_EQ(same_frame.calibration->held, (std::vector<std::string>{"camera2.ax", "camera2.tx_m"}));
  EXPECT_EQ(other.calibration->held, std::vector<std::string>{"camera2.ax"});
  ASSERT_EQ(other.calibration->outliers.size(), 1U);
  EXPECT_EQ(other.calibration->outliers[0].frame, 2);
  EXPECT_EQ(other.calibration->outliers[0].camera, 1);
  EXPECT_EQ(other.covariance->kind, CovarianceKind::clustered);
  EXPECT_EQ(other.calibration->dof, 1200);
  EXPECT_EQ(other.calibration->pixel_sigma_px, 0.2);
  EXPECT_EQ(other.other_keys, whole.other_keys);
  EXPECT_FALSE(other.evidence);
  EXPECT_TRUE(part_of(whole, {0, 1, 2, 3}).evidence) << "nothing changes if all are kept";
  const RigEstimate read = parse_rig(format_rig(other), "pair.json").estimate;
  EXPECT_LT(test::relative_difference(read.covariance->matrix(Eigen::seq(0, 4), Eigen::seq(0, 4)),
                                      other.covariance->matrix(Eigen::seq(0, 4), Eigen::seq(0, 4))),
            1e-9);
}

TEST(RigPart, RigHeldAsAWholeStaysHeld) {
  RigEstimate whole = calibrated(four_cameras());
  const int poses = pose_index(whole.rig, 1), n = parameter_count(whole.rig);
  whole.covariance->matrix.bottomRows(n - poses).setZero();
  whole.covariance->matrix.rightCols(n - poses).setZero();
  const RigEstimate part = part_of(whole, {1, 2});
  EXPECT_TRUE(part.covariance->matrix.bottomRows(6).isZero(0));
  EXPECT_GT(part.covariance->matrix(0, 0), 0);
}

TEST(RigPart, CamerasThatAreNoneAreRefused) {
  const Rig rig = four_cameras();
  EXPECT_NE(test::error_message([&] {
              part_of(rig, {0, 4});
            }).find("no camera 4"),
            std::string::npos);
  EXPECT_NE(test::error_message([&] {
              part_of(rig, {1, 1});
            }).find("camera 1 is kept twice"),
            std::string::npos);
  EXPECT_NE(test::error_message([&] { part_of(rig, {}); }).find("none"), std::string::npos);
}

TEST(RigPart, WhatNeedsAPairSaysHowToGetOne) {
  Rig rig = four_cameras();
  EXPECT_EQ(test::error_message([&] { require_pair(rig, "depth"); }),
            "depth: it needs a pair and the rig has 4 cameras; take two of them: vernier convert "
            "RIG --cameras left,right -o pair.json");
  EXPECT_EQ(test::error_message([&] { require_pair(part_of(rig, {2}), "r.json", "r.json"); }),
            "r.json: it needs a pair and the rig has 1 camera; give a rig of two cameras");
  require_pair(part_of(rig, {2, 0}), "depth");
}

}  // namespace
}  // namespace vernier
