// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/servo/goal_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/servo/stereo_line.h"
#include "stereo/segment.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::localise;
using namespace vernier::sim::internal;

namespace {

SpaceLine random_line(RandomStream& draws) {
  const Eigen::Vector3d u{draws.normal(), draws.normal(), draws.normal()};
  return {{draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(1, 4)}, u.normalized()};
}

Pose right_camera() { return test::nominal_rig().rig.T_camera_first[1]; }

/// The line in an image from two projected points: nothing of the code under test.
ImageLine through_points(const SpaceLine& line) {
  const Eigen::Vector3d a = line.point_m - 0.1 * line.direction;
  const Eigen::Vector3d b = line.point_m + 0.1 * line.direction;
  const Eigen::Vector3d n = Eigen::Vector3d(a / a.z()).cross(Eigen::Vector3d(b / b.z()));
  return n / n.head<2>().norm();
}

TEST(StereoLine, InteractionMatrixIsTheDerivative) {
  RandomStream draws({.seed = 2});
  for (int i = 0; i < 50; ++i) {
    const SpaceLine line = random_line(draws);
    const ImageLine at = through_points(line);
    const Eigen::Matrix<double, 2, 6> L = interaction(line);
    constexpr double h = 1e-6;
    for (int k = 0; k < 6; ++k) {
      Eigen::Vector2d ends[2];
      for (const int side : {0, 1}) {
        Eigen::Matrix<double, 6, 1> motion = Eigen::Matrix<double, 6, 1>::Zero();
        motion[k] = side ? h : -h;
        // The camera moves by it, so points move by the inverse.
        const Pose T_before_after{rotation_from_vector(motion.tail<3>()), motion.head<3>()};
        ImageLine n = through_points(moved(line, T_before_after.inverse()));
        if (n.head<2>().dot(at.head<2>()) < 0) n = -n;
        ends[side] = {-n.z(),
                      std::atan2(at.x() * n.y() - at.y() * n.x(), at.x() * n.x() + at.y() * n.y())};
      }
      Eigen::Vector2d numeric = (ends[1] - ends[0]) / (2 * h);
      // interaction() takes the sense of the line's direction, which turns rho's sign.
      const Eigen::Vector3d N = line.point_m.cross(line.direction);
      if (N.head<2>().dot(at.head<2>()) < 0) numeric[0] = -numeric[0];
      EXPECT_NEAR(L(0, k), numeric[0], 1e-6 * (1 + std::abs(numeric[0]))) << i << " " << k;
      EXPECT_NEAR(L(1, k), numeric[1], 1e-6 * (1 + std::abs(numeric[1]))) << i << " " << k;
    }
  }
}

// Espiau, Chaumette and Rives, the plane a X + b Y + c Z + d = 0 through the line.
TEST(StereoLine, InteractionMatrixIsThatOfThePaper) {
  RandomStream draws({.seed = 3});
  for (int i = 0; i < 50; ++i) {
    const SpaceLine line = random_line(draws);
    const Eigen::Vector3d N = line.point_m.cross(line.direction);
    const double scale = N.head<2>().norm();
    const double c = N.x() / scale, s = N.y() / scale, rho = -N.z() / scale;
    const Eigen::Vector3d plane = line.direction.cross(N);  // contains the line, not the camera
    const double d = -plane.dot(line.point_m);
    const double of_theta = (plane.x() * s - plane.y() * c) / d;
    const double of_rho = (plane.x() * rho * c + plane.y() * rho * s + plane.z()) / d;
    Eigen::Matrix<double, 2, 6> L;
    L << of_rho * c, of_rho * s, -of_rho * rho, (1 + rho * rho) * s, -(1 + rho * rho) * c, 0,
        of_theta * c, of_theta * s, -of_theta * rho, -rho * c, -rho * s, -1;
    EXPECT_LT((interaction(line) - L).cwiseAbs().maxCoeff(), 1e-9 * L.cwiseAbs().maxCoeff()) << i;
  }
}

TEST(StereoLine, FloorInteractionIsTheDerivative) {
  RandomStream draws({.seed = 4});
  const CameraMount mount{1.2, 0.2};
  for (int i = 0; i < 30; ++i) {
    const SpaceLine line = random_line(draws);
    StereoLine now = image_of(line, right_camera());
    if (i % 2) now.left = -now.left;
    if (i % 3) now.right = -now.right;
    const Eigen::Matrix<double, 4, 3> L = floor_interaction(line, now, right_camera(), mount);
    constexpr double h = 1e-6;
    for (int k = 0; k < 3; ++k) {
      const auto moved_by = [&](double by) {
        Eigen::Vector3d motion = Eigen::Vector3d::Zero();
        motion[k] = by;
        const Pose T = T_left_left(floor_motion(motion), {}, mount);
        return difference(image_of(moved(line, T), right_camera()), now);
      };
      const Eigen::Vector4d numeric = (moved_by(h) - moved_by(-h)) / (2 * h);
      for (int row = 0; row < 4; ++row) {
        EXPECT_NEAR(L(row, k), numeric[row], 1e-5 * (1 + std::abs(numeric[row]))) << row << k;
      }
    }
  }
}

TEST(StereoLine, SeesWhatTheRigImages) {
  const Rig& rig = test::nominal_rig().rig;
  const Eigen::Vector3d a(0.3, -0.5, 2.5), b(0.35, 0.6, 2.7);
  stereo::StereoSegment segment;
  segment.left = {project(rig.cameras[0], a), project(rig.cameras[0], b)};
  segment.right = {project(rig.cameras[1], right_camera() * a),
                   project(rig.cameras[1], right_camera() * b)};
  const auto seen = see(rig, segment);
  ASSERT_TRUE(seen);
  EXPECT_LT((b - a).normalized().cross(seen->space.direction).norm(), 1e-9);
  EXPECT_LT((seen->space.point_m - a).cross(seen->space.direction).norm(), 1e-9);
  EXPECT_LT(difference(seen->image, image_of(seen->space, right_camera())).norm(), 1e-12);
  // The ends in the other order are the same line.
  std::swap(segment.right.a_px, segment.right.b_px);
  EXPECT_LT(difference(see(rig, segment)->image, seen->image).norm(), 1e-12);
  std::swap(segment.left, segment.right);  // it would be behind the rig
  EXPECT_FALSE(see(rig, segment));
}

/// Upright lines and some slanted ones before the goal.
DesiredView some_view() {
  DesiredView view;
  view.T_right_left = right_camera();
  view.mount = {1.2, 0.1};
  view.focal_px = 500;
  RandomStream draws({.seed = 8});
  for (int i = 0; i < 10; ++i) {
    SpaceLine line{{-0.6 + 0.13 * i, 0.1, draws.uniform(1.6, 2.4)},
                   Eigen::Vector3d{0.02 * draws.normal(), 1, 0.05 * draws.normal()}.normalized()};
    view.lines.push_back({image_of(line, view.T_right_left), line, 300});
  }
  return view;
}

std::vector<LineMatch> seen_from(const DesiredView& view, const Pose2D& here) {
  const Pose T = T_left_left(here, {}, view.mount);
  std::vector<LineMatch> matches;
  for (std::size_t i = 0; i < view.lines.size(); ++i) {
    const SpaceLine line = moved(view.lines[i].space, T);
    SeenLine seen{image_of(line, view.T_right_left), line, 300};
    // The sense of a line is anyone's choice.
    if (i % 2) seen.image.left = -seen.image.left;
    if (i % 3) seen.image.right = -seen.image.right;
    if (i % 5) seen.space.direction = -seen.space.direction;
    matches.push_back({static_cast<int>(i), seen});
  }
  return matches;
}

TEST(GoalAlignment, ImageErrorSaysWhereTheGoalIs) {
  const DesiredView view = some_view();
  for (int i = 0; i < 27; ++i) {
    const Pose2D here{-0.1 * (i % 3), 0.05 * (i / 3 % 3 - 1), 0.05 * (i / 9 - 1)};
    const auto fix = goal_by_image_error(view, seen_from(view, here));
    ASSERT_TRUE(fix);
    const Pose2D goal = relative({}, here);
    const double far = std::hypot(here.x_m, here.y_m) + std::abs(here.heading_rad);
    EXPECT_LT(distance_m(fix->goal, goal), 0.1 * far * far + 1e-12) << i;
    EXPECT_LT(std::abs(fix->goal.heading_rad - goal.heading_rad), 0.1 * far * far + 1e-12) << i;
    EXPECT_EQ(fix->inliers, 10);
  }
}

TEST(GoalAlignment, NoImageErrorIsNoMotionWhateverTheDepths) {
  const DesiredView view = some_view();
  std::vector<LineMatch> matches = seen_from(view, {});
  for (LineMatch& m : matches) m.seen.space.point_m *= 1.7;
  const auto fix = goal_by_image_error(view, matches);
  ASSERT_TRUE(fix);
  EXPECT_LT(distance_m(fix->goal, {}), 1e-12);
  EXPECT_LT(fix->image_error_px, 1e-9);
}

TEST(GoalAlignment, FalseMatchesDoNotSteer) {
  const DesiredView view = some_view();
  const Pose2D here{-0.2, 0.05, 0.03};
  std::vector<LineMatch> matches = seen_from(view, here);
  for (const int wrong : {2, 7}) {
    matches[static_cast<std::size_t>(wrong)].seen.image = view.lines[4].image;
  }
  const auto fix = align_goal(view, matches, {});
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->inliers, 8);
  EXPECT_EQ(fix->weights[2], 0);
  EXPECT_LT(distance_m(fix->goal, relative({}, here)), 1e-6);
}

TEST(GoalAlignment, AlignsFromAfarToRounding) {
  const DesiredView view = some_view();
  for (const Pose2D& here : {Pose2D{-1, 0.3, 0.1}, Pose2D{-0.6, -0.4, -0.2}}) {
    const auto fix = align_goal(view, seen_from(view, here), relative({}, {-0.8, 0, 0}));
    ASSERT_TRUE(fix);
    EXPECT_LT(distance_m(fix->goal, relative({}, here)), 1e-5);
  }
  EXPECT_FALSE(align_goal(view, {}, {}));
}

}  // namespace
}  // namespace vernier
