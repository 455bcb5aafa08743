// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "tests/support/error_message.h"

namespace vernier::localise {
namespace {

using Eigen::Vector3d;
using test::error_message;

std::filesystem::path file_of(const std::string& text) {
  const auto file = std::filesystem::path(testing::TempDir()) / "trajectory.txt";
  std::ofstream(file) << text;
  return file;
}

std::string fault_of(const std::string& text) {
  return error_message([&] { read_trajectory(file_of(text)); });
}

/// A straight path of steps of one metre, along the optical axis.
std::vector<Pose> straight(int poses) {
  std::vector<Pose> path;
  for (int i = 0; i < poses; ++i) path.push_back({Eigen::Matrix3d::Identity(), Vector3d(0, 0, i)});
  return path;
}

TEST(Trajectory, WhatIsWrittenIsReadAgain) {
  const std::vector<TimedPose> path{
      {0.5, {}},
      {0.75, {rotation_from_vector({0.3, -2.9, 0.4}), {1.25, -3, 1e-7}}},
      {2, {rotation_from_vector({0, 3.1, 0}), {-4, 5, 6}}}};
  const std::vector<TimedPose> again = read_trajectory(file_of(tum_text(path)));
  ASSERT_EQ(again.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(again[i].time_s, path[i].time_s);
    EXPECT_EQ(again[i].T_world_camera.t, path[i].T_world_camera.t);
    EXPECT_LT((again[i].T_world_camera.R - path[i].T_world_camera.R).norm(), 1e-14);
  }
}

TEST(Trajectory, MatricesOfKittiAreRead) {
  const auto path = read_trajectory(
      file_of("# a comment\n1 0 0 0 0 1 0 0 0 0 1 0\n\n0 0 1 4 0 1 0 5 -1 0 0 6\r\n"));
  ASSERT_EQ(path.size(), 2U);
  EXPECT_EQ(path[1].time_s, 1);
  EXPECT_EQ(path[1].T_world_camera.t, Vector3d(4, 5, 6));
  EXPECT_LT((path[1].T_world_camera.R * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), 1e-15);
}

TEST(Trajectory, BadLinesAreNamed) {
  EXPECT_NE(fault_of("").find("holds no poses"), std::string::npos);
  EXPECT_NE(fault_of("0 1 2 3\n").find(":1: has 4 fields"), std::string::npos);
  EXPECT_NE(fault_of("0 0 0 0 0 0 0 1\n1 0 0 0 0 1 0 0 0 0 1 0\n").find(":2: has 12 fields"),
            std::string::npos);
  EXPECT_NE(fault_of("0 0 0 0 0 0 0 2\n").find("not of length 1"), std::string::npos);
  EXPECT_NE(fault_of("0 0 0 0 0 0 0 0\n").find("not of length 1"), std::string::npos);
  EXPECT_NE(fault_of("1 0 0 0 0 1 0 0 0 0 -1 0\n").find("not a rotation"), std::string::npos);
  EXPECT_NE(fault_of("2 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n").find(":2: its time"), std::string::npos);
  EXPECT_NE(fault_of("0 nan 0 0 0 0 0 1\n").find(":1: "), std::string::npos);
  EXPECT_NE(fault_of("0 1e10 0 0 0 0 0 1\n").find("beyond 1e+09 m"), std::string::npos);
}

TEST(Trajectory, DriftIsThatOfTheSegments) {
  const std::vector<Pose> truth = straight(31);
  std::vector<Pose> longer = truth, turning = truth;
  constexpr double scale = 1.02, rad_per_m = 0.01;
  for (int i = 0; i <= 30; ++i) {
    longer[i].t *= scale;
    turning[i].R = rotation_from_vector({0, rad_per_m * i, 0});
  }
  const TrajectoryDrift by_scale = drift_of(longer, truth, 10);
  EXPECT_NEAR(by_scale.length_m, 30, 1e-12);
  EXPECT_NEAR(by_scale.translation_share, 0.02, 1e-12);
  EXPECT_NEAR(by_scale.rotation_rad_per_m, 0, 1e-9);
  EXPECT_NEAR(by_scale.end_error_m, 0.6, 1e-12);
  EXPECT_EQ(by_scale.segments, 21);
  EXPECT_NEAR(drift_of(turning, truth, 10).rotation_rad_per_m, rad_per_m, 1e-9);
  EXPECT_EQ(drift_of(turning, truth, 31).segments, 0);
}

TEST(Trajectory, DriftIgnoresWhereThePathBegins) {
  const std::vector<Pose> truth = straight(31);
  const Pose elsewhere{rotation_from_vector({0.4, 1, -0.3}), {7, -8, 9}};
  std::vector<Pose> moved;
  for (const Pose& T : truth) moved.push_back(elsewhere * T);
  const TrajectoryDrift drift = drift_of(moved, truth, 5);
  EXPECT_NEAR(drift.end_error_m, 0, 1e-9);
  EXPECT_NEAR(drift.translation_share, 0, 1e-9);
}

TEST(Trajectory, DriftOfUnequalTrajectoriesIsRefused) {
  EXPECT_NE(error_message([] { drift_of(straight(3), straight(4), 1); }).find("3 poses"),
            std::string::npos);
  EXPECT_NE(error_message([] { drift_of(straight(1), straight(1), 1); }), "");
}

TEST(Trajectory, DriftOverNoLengthIsRefused) {
  for (const double segment_m : {0.0, -1.0, std::nan("")}) {
    EXPECT_EQ(error_message([&] { drift_of(straight(3), straight(3), segment_m); }),
              "trajectory: the length of a segment is not above 0; give it in metres");
  }
}

TEST(Trajectory, NoErrorInUnitsOfACovarianceThatIsNone) {
  MotionStep step;
  step.by_rig.setZero(6, 16);
  step.covariance.setIdentity();
  EXPECT_EQ(step_nees(step, {}), 0);
  step.covariance.setZero();
  EXPECT_NE(error_message([&] { step_nees(step, {}); }).find("not positive definite"),
            std::string::npos);
  step.covariance.setIdentity();
  Pose nowhere;
  nowhere.t.x() = std::nan("");
  EXPECT_NE(error_message([&] { step_nees(step, nowhere); }), "");
}

}  // namespace
}  // namespace vernier::localise
