// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "calib/base/ordered_parallel.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/robot/floor_contact.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/support/error_message.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

using test::error_message;

Robot office_robot(const RobotOptions& options = {}) {
  return {test::small_office_visibility(), test::nominal_rig(), options};
}

Pose2D start_in_office() { return route_point(test::small_office().route, 1).pose; }

const std::vector<DriveCommand>& some_commands() {
  static const std::vector<DriveCommand> commands{
      {0.3, 0, 0.5}, {0.3, 0.4, 0.5}, {0, 0, 0.2}, {0.2, -0.6, 0.7}, {-0.2, 0.1, 0.4}};
  return commands;
}

/// All numbers of an observation, to the bit.
std::vector<double> numbers(const RobotObservation& o) {
  std::vector<double> all{
      static_cast<double>(o.frame), o.time_s,         o.odometry.x_m,    o.odometry.y_m,
      o.odometry.heading_rad,       o.left_wheel_rad, o.right_wheel_rad, o.contact ? 1.0 : 0.0};
  for (const stereo::StereoSegment& s : o.view.segments) {
    for (const Eigen::Vector2d& p : {s.left.a_px, s.left.b_px, s.right.a_px, s.right.b_px}) {
      all.insert(all.end(), {p.x(), p.y()});
    }
  }
  for (const SensedCorner& c : o.view.corners) {
    for (const Eigen::Vector2d& p : c.pixel_px) all.insert(all.end(), {p.x(), p.y()});
  }
  return all;
}

std::vector<double> drive_of(Robot robot, std::uint32_t trial) {
  std::vector<double> all = numbers(robot.reset(4, trial, start_in_office()));
  for (const DriveCommand& command : some_commands()) {
    const std::vector<double> more = numbers(robot.step(command));
    all.insert(all.end(), more.begin(), more.end());
  }
  for (const double p :
       {robot.true_pose().x_m, robot.true_pose().y_m, parameters(robot.told_rig())[0]}) {
    all.push_back(p);
  }
  return all;
}

TEST(Robot, ATrialIsRepeatableFromItsCommandsOnAnyNumberOfThreads) {
  RobotOptions options;
  options.with_corners = true;
  const Robot robot = office_robot(options);
  constexpr std::size_t trials = 6;
  std::vector<std::vector<double>> first(trials);
  for (std::size_t i = 0; i < trials; ++i)
    first[i] = drive_of(robot, static_cast<std::uint32_t>(i));
  EXPECT_NE(first[0], first[1]);
  for (const int threads : {1, 2, 8}) {
    std::vector<std::vector<double>> again(trials);
    for_each_index(trials, threads, [&](std::size_t i) {
      again[i] = drive_of(robot, static_cast<std::uint32_t>(i));
    });
    EXPECT_EQ(again, first) << threads << " threads";
  }
}

TEST(Robot, ResetForgetsWhatWasBefore) {
  Robot robot = office_robot();
  const std::vector<double> fresh = numbers(robot.reset(4, 2, start_in_office()));
  for (const DriveCommand& command : some_commands()) robot.step(command);
  EXPECT_EQ(numbers(robot.reset(4, 2, start_in_office())), fresh);
  EXPECT_EQ(robot.true_pose(), start_in_office());
}

TEST(Robot, FramesKeyTheDraws) {
  Robot robot = office_robot();
  const RobotObservation at_rest = robot.reset(4, 0, start_in_office());
  const RobotObservation waited = robot.step({0, 0, 0.1});
  EXPECT_EQ(waited.frame, 1u);
  EXPECT_EQ(robot.true_pose(), start_in_office());
  // Standing still it sees the same through other noise, and again the same in the same frame.
  EXPECT_NE(numbers(at_rest), numbers(waited));
  const StereoObservation again = robot.view_from(start_in_office(), 1);
  ASSERT_EQ(again.segments.size(), waited.view.segments.size());
  for (std::size_t i = 0; i < again.segments.size(); ++i) {
    EXPECT_EQ(again.segments[i].left.a_px, waited.view.segments[i].left.a_px);
  }
}

TEST(Robot, SwitchingASourceLeavesOtherDrawsAlone) {
  RobotOptions all;
  const auto end_of = [&](const RobotOptions& options) {
    Robot robot = office_robot(options);
    robot.reset(4, 1, start_in_office());
    for (const DriveCommand& command : some_commands()) robot.step(command);
    return robot;
  };
  const Robot with_all = end_of(all);
  RobotOptions no_view_errors = all;
  no_view_errors.sources = no_sources();
  EXPECT_EQ(end_of(no_view_errors).true_pose(), with_all.true_pose());
  RobotOptions exact_wheels = all;
  exact_wheels.odometry = no_odometry_error();
  const Robot exact = end_of(exact_wheels);
  EXPECT_NE(exact.true_pose(), with_all.true_pose());
  EXPECT_EQ(parameters(exact.told_rig()), parameters(with_all.told_rig()));
  RobotOptions rough_floor = all;  // noise of steps leaves the wheels that were drawn alone
  rough_floor.odometry.turn_per_way = 1e-2;
  RobotOptions smooth_floor = all;
  smooth_floor.odometry.turn_per_way = 0;
  Robot rough = office_robot(rough_floor), smooth = office_robot(smooth_floor);
  rough.reset(4, 1, start_in_office());
  smooth.reset(4, 1, start_in_office());
  const DriveCommand forward{0.3, 0, 0.5};
  rough.step(forward);
  smooth.step(forward);
  EXPECT_NEAR(distance_m(rough.true_pose(), start_in_office()),
              distance_m(smooth.true_pose(), start_in_office()), 1e-4);
}

TEST(Robot, OdometryWithoutErrorIsTheTruth) {
  RobotOptions options;
  options.odometry = no_odometry_error();
  Robot robot = office_robot(options);
  RobotObservation seen = robot.reset(4, 0, start_in_office());
  double left = 0, right = 0;
  for (const DriveCommand& command : some_commands()) {
    seen = robot.step(command);
    left += seen.left_wheel_rad;
    right += seen.right_wheel_rad;
  }
  const Pose2D told = compose(start_in_office(), seen.odometry);
  EXPECT_NEAR(distance_m(told, robot.true_pose()), 0, 1e-12);
  EXPECT_NEAR(heading_difference_rad(told, robot.true_pose()), 0, 1e-12);
  const DifferentialDrive& drive = options.drive;
  EXPECT_NEAR(std::remainder((right - left) * drive.wheel_radius_m / drive.wheel_base_m -
                                 seen.odometry.heading_rad,
                             2 * std::numbers::pi),
              0, 1e-12);
}

/// A floor with one wall along y at x = 1, and a table whose top is at 0.7 m.
World wall_and_table() {
  World world;
  world.objects.push_back({});
  world.surfaces.push_back({{{1, -3, 0}, {1, 3, 0}, {1, 3, 2.5}, {1, -3, 2.5}}, 0});
  world.surfaces.push_back({{{-2, 1, 0.7}, {-1, 1, 0.7}, {-1, 2, 0.7}, {-2, 2, 0.7}}, 0});
  world.surfaces.push_back({{{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}}, 0});  // floor
  world.surfaces.push_back({{{-4, -4, 2.5}, {4, -4, 2.5}, {4, 4, 2.5}, {-4, 4, 2.5}}, 0});
  for (const WorldSurface& s : world.surfaces) {
    for (std::size_t i = 0; i < s.polygon_m.size(); ++i) {
      world.segments.push_back({s.polygon_m[i], s.polygon_m[(i + 1) % s.polygon_m.size()], 0});
    }
  }
  return world;
}

TEST(RobotContact, StopsAtTheWallAndSaysSo) {
  const World world = wall_and_table();
  const Visibility visibility(world);
  RobotOptions options;
  options.odometry = no_odometry_error();
  Robot robot(visibility, test::nominal_rig(), options);
  robot.reset(1, 0, {0, 0, 0});
  RobotObservation seen = robot.step({1, 0, 3});
  EXPECT_TRUE(seen.contact);
  EXPECT_NEAR(robot.true_pose().x_m, 0.8, 2e-5);  // a body of 0.2 m
  EXPECT_LE(robot.true_pose().x_m, 0.8);
  EXPECT_NEAR(seen.odometry.x_m, robot.true_pose().x_m, 1e-9);  // the wheels have stopped too
  EXPECT_DOUBLE_EQ(seen.time_s, 3);
  // Against it again: contact without motion. Away, and around on the spot: free.
  const Pose2D there = robot.true_pose();
  EXPECT_TRUE(robot.step({0.5, 0, 0.5}).contact);
  EXPECT_EQ(robot.true_pose(), there);
  EXPECT_FALSE(robot.step({0, 0.5, 0.5}).contact);
  EXPECT_NEAR(distance_m(robot.true_pose(), there), 0, 1e-12);
  EXPECT_FALSE(robot.step({-0.5, 0, 0.5}).contact);
  EXPECT_LT(robot.true_pose().x_m, 0.7);
}

// From many sides, at many angles: the end is never within the body's radius, and a little more of
// the way would have been.
TEST(RobotContact, StopsNeitherTooEarlyNorTooLate) {
  const World world = wall_and_table();
  const Obstacles obstacles(world, 1.4);
  constexpr double radius = 0.2;
  int contacts = 0;
  for (int i = 0; i < 200; ++i) {
    const Pose2D start{-0.5 + 0.001 * i, 0.3 - 0.002 * i, 0.0314 * i};
    const DrivePhase phase{6, 0.6, 0.6, 0.15 * std::sin(0.7 * i), 0.15 * std::sin(0.7 * i)};
    const Obstacles::Advance end = obstacles.advance(start, std::vector{phase}, radius);
    // The first contact by dense sampling.
    double first = phase.duration_s;
    for (double t = 0; t < phase.duration_s; t += 1e-3) {
      const Pose2D at = compose(start, phase.after(t));
      if (obstacles.distance_m({at.x_m, at.y_m}, 1) < radius) {
        first = t;
        break;
      }
    }
    EXPECT_EQ(end.contact, first < phase.duration_s) << i;
    EXPECT_NEAR(end.time_s, first, 2e-2) << i;
    EXPECT_LE(end.time_s, first) << i;
    EXPECT_GE(obstacles.distance_m({end.pose.x_m, end.pose.y_m}, 1), radius) << i;
    if (end.contact) {
      EXPECT_NEAR(obstacles.distance_m({end.pose.x_m, end.pose.y_m}, 1), radius, 1e-5) << i;
    }
    contacts += end.contact;
  }
  EXPECT_GT(contacts, 60);
  EXPECT_LT(contacts, 180);
}

TEST(RobotContact, SlidesAlongAWallItTouches) {
  const Obstacles obstacles(wall_and_table(), 1.4);
  const DrivePhase along{1, 0.5, 0.5, 0, 0};
  const auto end = obstacles.advance({0.8, -1, std::numbers::pi / 2}, std::vector{along}, 0.2);
  EXPECT_FALSE(end.contact);
  EXPECT_NEAR(end.pose.y_m, -0.5, 1e-12);
}

TEST(Robot, RefusesWhatItCannotDoAndStaysWhereItWas) {
  Robot robot = office_robot();
  EXPECT_NE(error_message([&] {
              robot.step({0.1, 0, 1});
            }).find("call reset first"),
            std::string::npos);
  robot.reset(4, 0, start_in_office());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_message([&] { robot.step({nan, 0, 1}); }), "");
  EXPECT_EQ(robot.step({0, 0, 0.1}).frame, 1u);
  EXPECT_NE(error_message([&] {
              robot.reset(4, 0, {-50, 0, 0});
            }).find("is outside the world"),
            std::string::npos);
  EXPECT_EQ(robot.true_pose(), start_in_office());
  RobotOptions wide;
  wide.drive.body_radius_m = 1.5;
  Robot giant = office_robot(wide);
  EXPECT_NE(error_message([&] {
              giant.reset(4, 0, start_in_office());
            }).find("nearer than its body's radius of 1.5 m"),
            std::string::npos);
  RobotOptions moved;
  moved.sources.moved = 0.2;
  EXPECT_NE(error_message([&] { office_robot(moved); }).find("with_moved_furniture"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
