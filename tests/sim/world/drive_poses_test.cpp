// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "calib/error.h"
#include "localise/place.h"
#include "sim/world.h"

namespace vernier::sim {
namespace {

using localise::Pose2D;

/// The smallest angle between two headings.
double turn(const Pose2D& a, const Pose2D& b) {
  return std::abs(std::remainder(b.heading_rad - a.heading_rad, 2 * std::numbers::pi));
}

TEST(DrivePoses, StepsAreSmallAndCoverTheLeg) {
  const RouteLeg leg{{{0, 0}, {3, 0}, {3, 2}, {0, 2}}};
  const std::vector<Pose2D> poses = drive_poses(leg, 0.4, 0.2);
  double length = 0, turned = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double step =
        std::hypot(poses[i].x_m - poses[i - 1].x_m, poses[i].y_m - poses[i - 1].y_m);
    EXPECT_LE(step, 0.4 + 1e-12);
    EXPECT_LE(turn(poses[i - 1], poses[i]), 0.2 + 1e-12);
    EXPECT_TRUE(step < 1e-12 || turn(poses[i - 1], poses[i]) < 1e-12) << "turns on the spot";
    length += step;
    turned += turn(poses[i - 1], poses[i]);
  }
  EXPECT_NEAR(length, 8, 1e-9);
  EXPECT_NEAR(turned, std::numbers::pi, 1e-9);
  EXPECT_NEAR(poses.front().x_m, 0, 1e-12);
  EXPECT_NEAR(poses.back().x_m, 0, 1e-9);
  EXPECT_NEAR(poses.back().y_m, 2, 1e-9);
}

TEST(DrivePoses, ImpossibleStepsAreRefused) {
  const RouteLeg leg{{{0, 0}, {3, 0}}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(drive_poses(leg, 0, 0.1), Error);
  EXPECT_THROW(drive_poses(leg, 0.1, -1), Error);
  EXPECT_THROW(drive_poses(leg, nan, 0.1), Error);
  EXPECT_THROW(drive_poses(leg, 1e-9, 0.1), Error);
}

}  // namespace
}  // namespace vernier::sim
