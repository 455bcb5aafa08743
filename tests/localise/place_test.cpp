// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calib/pose.h"
#include "stereo/segment.h"

namespace vernier {

using namespace vernier::localise;
using namespace vernier::stereo;

namespace {

TEST(PlanePoses, DifferencesAndComposition) {
  const Pose2D a{1, 2, 3.1}, b{1, 2, -3.1};
  EXPECT_NEAR(heading_difference_rad(a, b), 6.2 - 2 * std::numbers::pi, 1e-12);
  const Pose2D c = compose({1, 0, std::numbers::pi / 2}, {2, 0, 0.1});
  EXPECT_NEAR(c.x_m, 1, 1e-12);
  EXPECT_NEAR(c.y_m, 2, 1e-12);
}

TEST(PlanePoses, HeadingDifferencesLieAboveMinusPiAndUpToPi) {
  constexpr double pi = std::numbers::pi;
  const auto difference = [](double a, double b) {
    return heading_difference_rad({0, 0, a}, {0, 0, b});
  };
  EXPECT_EQ(difference(0, pi), pi);
  EXPECT_EQ(difference(pi, 0), pi);
  EXPECT_EQ(difference(0, -pi), pi);
  EXPECT_EQ(difference(-pi, 0), pi);
  EXPECT_EQ(difference(pi, -pi), 0);
  EXPECT_EQ(difference(0, 0), 0);
  EXPECT_NEAR(difference(0.5 * pi, 0), 0.5 * pi, 1e-15);  // counter-clockwise is positive
  EXPECT_NEAR(difference(0, 0.5 * pi), -0.5 * pi, 1e-15);
  const double below = std::nextafter(pi, 0);
  EXPECT_EQ(difference(below, 0), below);
  EXPECT_EQ(difference(0, below), -below);
  EXPECT_NEAR(difference(0, pi + 0.1), pi - 0.1, 1e-12);
  EXPECT_NEAR(difference(7 * pi + 0.1, 0), -pi + 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(difference(std::nan(""), 0)));
  for (int turns = -9; turns <= 9; ++turns) {
    const double found = difference(turns * pi, 0);
    EXPECT_GT(found, -pi);
    EXPECT_LE(found, pi);
  }
}

TEST(CameraMounts, AxesAndPitch) {
  const Pose level = T_robot_camera({1.2, 0});
  EXPECT_LT((level * Eigen::Vector3d(0, 0, 2) - Eigen::Vector3d(2, 0, 1.2)).norm(), 1e-14);
  EXPECT_LT((level * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, -1, 1.2)).norm(), 1e-14);
  const Pose down = T_robot_camera({1.2, 0.1});
  EXPECT_LT((down * Eigen::Vector3d(0, 0, 1)).z(), 1.2);  // nose down looks lower
}

TEST(PlaceViews, NearlyUprightLinesBecomeUpright) {
  // camera frame: x right, y down, z forward; ends' depths differ within their error
  const SpaceSegment s{{0.5, -0.5, 3.0}, {0.5, 0.9, 3.1}, 0.05, true};
  const StereoSegment image{{{400, 150}, {402, 390}}, {}, 0};
  const PlaceView view = select_lines({&s, 1}, {&image, 1}, {1.2, 0});
  ASSERT_EQ(view.lines.size(), 1u);
  EXPECT_EQ(view.lines[0].kind, LineKind::vertical);
  EXPECT_EQ(view.lines[0].a_m.x(), view.lines[0].b_m.x());
  EXPECT_EQ(view.lines[0].a_m.y(), view.lines[0].b_m.y());
}

TEST(PlaceViews, UnreliableAndFarLinesAreLeftOut) {
  const SpaceSegment bad[] = {{{0, 0, 3}, {0, 1, 3}, 0.05, false},
                              {{0, 0, 3}, {0, 1, 3}, 0.9, true},
                              {{0, 0, 20}, {0, 1, 20}, 0.1, true}};
  const StereoSegment images[3] = {};
  const PlaceView view = select_lines(bad, images, {});
  EXPECT_TRUE(view.lines.empty());
  EXPECT_EQ(view.image_lines.size(), 3u);
}

}  // namespace
}  // namespace vernier
