// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visual_servo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig_estimate.h"
#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/robot.h"
#include "sim/servo/servo_control.h"
#include "sim/sources.h"
#include "tests/support/error_message.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

using test::error_message;

ServoExperiment office_servo(const RobotOptions& robot, const ServoOptions& servo = {}) {
  return {test::small_office_visibility(), test::nominal_rig(), robot, servo};
}

RobotOptions exact_robot() {
  RobotOptions robot;
  robot.odometry = no_odometry_error();
  robot.sources = no_sources();
  return robot;
}

// The law alone, on a robot that knows its place: from every start of a grid it comes within 1 cm
// of the goal and its axis.
TEST(ServoLaw, ArrivesAlongTheAxisOfTheGoal) {
  const ServoLaw law;
  for (int i = 0; i < 75; ++i) {
    const Pose2D start{-0.6 - 0.2 * (i % 5), 0.2 * (i / 5 % 5 - 2), 0.17 * (i / 25 - 1)};
    Pose2D here = start;
    for (int step = 0; step < 200; ++step) {
      const Pose2D goal = relative({}, here);
      if (goal.x_m < 0.01) break;
      const DriveCommand c = approach(goal, law);
      EXPECT_LE(std::abs(c.speed_mps), law.fastest_mps * (1 + 1e-12));
      EXPECT_LE(std::abs(c.turn_radps), law.fastest_radps * (1 + 1e-12));
      here = compose(
          here,
          DrivePhase{c.duration_s, c.speed_mps, c.speed_mps, c.turn_radps, c.turn_radps}.after(
              c.duration_s));
    }
    EXPECT_LT(std::abs(here.x_m), 0.02) << i;
    EXPECT_LT(std::abs(here.y_m), 0.01) << i;
  }
}

TEST(ServoControl, RetreatsFromBesideTheGoalAndFromWhatItTouches) {
  ServoControl beside({0.001, 0.1, 0}, {});
  for (int frame = 0; frame < 3; ++frame)
    EXPECT_NEAR(beside.next(true, false)->speed_mps, 0.001, 1e-12);
  EXPECT_LT(beside.next(true, false)->speed_mps, 0);
  EXPECT_EQ(beside.retreats(), 1);
  EXPECT_GT(beside.next(true, true)->speed_mps, -0.1);  // something is behind it
  ServoControl at_goal({0.001, 0.001, 0.001}, {});
  for (int frame = 0; frame < 10; ++frame) EXPECT_TRUE(at_goal.next(false, false));  // unseen
  for (int frame = 0; frame < 3; ++frame) EXPECT_TRUE(at_goal.next(true, false));
  EXPECT_FALSE(at_goal.next(true, false));
  ServoControl on_the_way({1, 0, 0}, {});
  EXPECT_GT(on_the_way.next(true, false)->speed_mps, 0);
  EXPECT_LT(on_the_way.next(true, true)->speed_mps, 0);
}

// Starts are drawn over the whole range, so these are a grid of starts and doors. Without errors
// the robot stands at the goal, by all three desired views alike.
TEST(VisualServo, ConvergesWithoutErrors) {
  for (const ServoGoal goal : {ServoGoal::taught, ServoGoal::recorded, ServoGoal::model}) {
    ServoOptions servo;
    servo.goal = goal;
    const ServoExperiment experiment = office_servo(exact_robot(), servo);
    for (std::uint32_t trial = 0; trial < 12; ++trial) {
      const ServoTrial t = experiment.run(7, trial);
      EXPECT_EQ(t.status, ServoStatus::converged) << name(goal) << trial;
      EXPECT_LT(t.position_error_m, 0.025) << name(goal) << trial;
      EXPECT_LT(std::abs(t.heading_error_rad), 0.01) << name(goal) << trial;
      EXPECT_EQ(t.contacts, 0);
    }
  }
}

// Level lines are told apart by stereo where the baseline is tilted, and then are among those that
// are followed.
TEST(VisualServo, ConvergesWithATiltedBaselineAndARolledCamera) {
  RigEstimate tilted = test::nominal_rig(), rolled = test::nominal_rig();
  tilted.rig.T_camera_first[1].t.y() = 0.3 * tilted.rig.T_camera_first[1].t.norm();
  const Eigen::Matrix3d roll = rotation_from_vector({0, 0, 1.5});
  Pose& T = rolled.rig.T_camera_first[1];
  T = {roll * T.R, roll * T.t};
  for (const RigEstimate& rig : {tilted, rolled}) {
    const ServoExperiment experiment(test::small_office_visibility(), rig, exact_robot(), {});
    int converged = 0;
    for (std::uint32_t trial = 0; trial < 8; ++trial) {
      const ServoTrial t = experiment.run(7, trial);
      if (t.status != ServoStatus::converged) continue;
      ++converged;
      EXPECT_LT(t.position_error_m, 0.03) << trial;
    }
    EXPECT_GE(converged, 6);  // a rolled image is narrower, and may not hold the door at the start
  }
}

TEST(VisualServo, IsTheSameOnAnyNumberOfThreads) {
  const ServoExperiment experiment = office_servo({});
  constexpr std::size_t trials = 6;
  std::vector<ServoTrial> first(trials);
  for (std::size_t i = 0; i < trials; ++i)
    first[i] = experiment.run(3, static_cast<std::uint32_t>(i));
  for (const int threads : {2, 8}) {
    std::vector<ServoTrial> again(trials);
    for_each_index(trials, threads, [&](std::size_t i) {
      again[i] = experiment.run(3, static_cast<std::uint32_t>(i));
    });
    for (std::size_t i = 0; i < trials; ++i) {
      EXPECT_EQ(again[i].way, first[i].way);
      EXPECT_EQ(again[i].status, first[i].status);
      EXPECT_EQ(again[i].image_error_px, first[i].image_error_px);
    }
  }
}

TEST(VisualServo, DoorsAndStartsDoNotDependOnErrors) {
  ServoOptions model;
  model.goal = ServoGoal::model;
  model.law.time_limit_s = 1;
  const ServoExperiment noisy = office_servo({}, model), exact = office_servo(exact_robot(), model);
  for (std::uint32_t trial = 0; trial < 8; ++trial) {
    EXPECT_EQ(noisy.run(5, trial).start, exact.run(5, trial).start);
    EXPECT_EQ(noisy.run(5, trial).goal, exact.run(5, trial).goal);
  }
}

TEST(VisualServo, RefusesCamerasAboveEachOther) {
  RigEstimate rig = test::nominal_rig();
  rig.rig.T_camera_first[1].t = {0, -0.12, 0};
  EXPECT_NE(error_message([&] {
              ServoExperiment(test::small_office_visibility(), rig, exact_robot(), {});
            }).find("the baseline is 45° or more from level"),
            std::string::npos);
}

TEST(VisualServo, RefusesWhatIsNotThere) {
  ServoOptions servo;
  servo.door = "gate";
  EXPECT_NE(error_message([&] { office_servo({}, servo); }).find("gate: is no template"),
            std::string::npos);
  servo = {};
  servo.distance_m = 30;
  EXPECT_NE(error_message([&] { office_servo({}, servo); }).find("has no free place 30 m"),
            std::string::npos);
  servo = {};
  servo.law.fix_share = 0;
  EXPECT_NE(error_message([&] { office_servo({}, servo); }).find("fix_share"), std::string::npos);
  EXPECT_NE(error_message([] { servo_goal("guessed"); }).find("use taught, recorded or model"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
