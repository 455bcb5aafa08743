// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/differential_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "calib/error.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "tests/support/error_message.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;

namespace {

using test::error_message;

/// The wheels simulated in small steps, each by the midpoint rule: nothing of the code under test.
Pose2D small_steps(const DifferentialDrive& drive, const DriveCommand& c, WheelSpeeds& wheels) {
  const double left = c.speed_mps - 0.5 * drive.wheel_base_m * c.turn_radps;
  const double right = c.speed_mps + 0.5 * drive.wheel_base_m * c.turn_radps;
  const WheelSpeeds from = wheels;
  const double needed = std::max(std::abs(left - from.left_mps), std::abs(right - from.right_mps)) /
                        drive.max_acceleration_mps2;
  const auto at = [&](double t) {
    const double share = needed > 0 ? std::min(1.0, t / needed) : 1;
    return WheelSpeeds{from.left_mps + share * (left - from.left_mps),
                       from.right_mps + share * (right - from.right_mps)};
  };
  constexpr int steps = 200'000;
  const double h = c.duration_s / steps;
  double x = 0, y = 0, heading = 0;
  for (int i = 0; i < steps; ++i) {
    wheels = at((i + 0.5) * h);
    const double v = 0.5 * (wheels.left_mps + wheels.right_mps);
    const double w = (wheels.right_mps - wheels.left_mps) / drive.wheel_base_m;
    x += h * v * std::cos(heading + 0.5 * h * w);
    y += h * v * std::sin(heading + 0.5 * h * w);
    heading += h * w;
  }
  wheels = at(c.duration_s);
  return {x, y, heading};
}

TEST(DifferentialDrive, IntegratesAsManySmallStepsDo) {
  const DifferentialDrive drive;
  WheelSpeeds exact, stepped;
  RandomStream draws({.seed = 3});
  for (int i = 0; i < 25; ++i) {
    const double forward = draws.uniform(-1, 1), turn = draws.uniform(-1, 1);
    const DriveCommand command = wheel_command(drive, forward, turn, draws.uniform(0.05, 3));
    const Pose2D end = after(wheel_phases(drive, command, exact));
    const Pose2D truth = small_steps(drive, command, stepped);
    EXPECT_NEAR(end.x_m, truth.x_m, 2e-9);
    EXPECT_NEAR(end.y_m, truth.y_m, 2e-9);
    EXPECT_NEAR(end.heading_rad, truth.heading_rad, 1e-8);
    EXPECT_NEAR(exact.left_mps, stepped.left_mps, 1e-12);
    EXPECT_NEAR(exact.right_mps, stepped.right_mps, 1e-12);
  }
}

TEST(DifferentialDrive, ClosesACircleAndTurnsOnTheSpot) {
  const double pi = std::acos(-1);
  const DrivePhase circle{2 * pi, 0.5, 0.5, 1, 1};
  EXPECT_NEAR(circle.after(pi).y_m, 1, 1e-15);  // its diameter
  EXPECT_NEAR(std::hypot(circle.after(2 * pi).x_m, circle.after(2 * pi).y_m), 0, 1e-15);
  const Pose2D turned = DrivePhase{1, 0, 0, 1, 1}.after(1);
  EXPECT_EQ(turned, (Pose2D{0, 0, 1}));
  // Nearly straight is as good as straight.
  const Pose2D straight = DrivePhase{1, 1, 1, 0, 0}.after(1);
  EXPECT_EQ(straight, (Pose2D{1, 0, 0}));
  EXPECT_NEAR((DrivePhase{1, 1, 1, 1e-9, 1e-9}.after(1).y_m), 0.5e-9, 1e-20);
  EXPECT_NEAR((DrivePhase{1, 1, 1, 2.0001e-4, 2.0001e-4}.after(1).y_m),
              (DrivePhase{1, 1, 1, 1.9999e-4, 1.9999e-4}.after(1).y_m), 1.1e-8);
}

TEST(DifferentialDrive, CutIntoStepsItIsTheSameDrive) {
  const DifferentialDrive drive;
  WheelSpeeds once, often;
  const Pose2D end = after(wheel_phases(drive, {0.6, 0.9, 2}, once));
  Pose2D pose;
  for (int i = 0; i < 40; ++i) {
    pose = compose(pose, after(wheel_phases(drive, {0.6, 0.9, 0.05}, often)));
  }
  EXPECT_NEAR(pose.x_m, end.x_m, 1e-12);
  EXPECT_NEAR(pose.y_m, end.y_m, 1e-12);
  EXPECT_NEAR(pose.heading_rad, end.heading_rad, 1e-12);
}

TEST(DifferentialDrive, WaysCountBackwardsToo) {
  const DrivePhase there_and_back{2, 1, -1, 3, -1};
  EXPECT_NEAR(there_and_back.way_m(), 1, 1e-15);
  EXPECT_NEAR(there_and_back.turned_rad(), 2.5, 1e-15);  // 9/4 left, 1/4 right
}

TEST(DifferentialDrive, WithoutErrorTheTruthIsWhatItBelieves) {
  const DifferentialDrive drive;
  const OdometryDraw exact(drive, no_odometry_error(), 7, 3);
  WheelSpeeds wheels;
  for (const DriveCommand& c : {DriveCommand{0.3, 0.5, 1}, DriveCommand{-0.2, 1.7, 0.3}}) {
    const std::vector<DrivePhase> believed = wheel_phases(drive, c, wheels);
    EXPECT_EQ(after(exact.true_phases(believed, 4)), after(believed));
  }
}

TEST(DifferentialDrive, RefusesCommandsInOneLine) {
  const DifferentialDrive drive;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto said = [&](const DriveCommand& c) {
    return error_message([&] { check(c, drive, "commands.csv:3"); });
  };
  EXPECT_EQ(said({0.5, 0.5, 0.1}), "");
  EXPECT_EQ(said({1, 0, 0.1}), "");  // the limit itself
  EXPECT_NE(said({nan, 0, 0.1}).find("commands.csv:3: a speed is not a finite number"),
            std::string::npos);
  for (const double bad : {0.0, -1.0, 61.0, nan}) {
    EXPECT_NE(said({0.5, 0, bad}).find("the duration of"), std::string::npos) << bad;
  }
  EXPECT_NE(said({0.9, 1, 0.1}).find("a wheel would run at 1.1 m/s"), std::string::npos);
  DifferentialDrive flat;
  flat.wheel_radius_m = 0;
  EXPECT_NE(error_message([&] { check(flat, "robot"); }).find("wheel_radius_m is 0"),
            std::string::npos);
  OdometryError absurd;
  absurd.way_per_way = -1;
  EXPECT_NE(error_message([&] { check(absurd, "robot"); }).find("way_per_way is -1"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
