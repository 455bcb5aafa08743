// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/corner_drive.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/statistics/distributions.h"
#include "calib/triangulation.h"
#include "localise/odometry.h"
#include "localise/place.h"
#include "localise/trajectory.h"
#include "sim/corner_appearance.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/world.h"
#include "tests/support/small_office.h"

namespace vernier {
namespace {

using namespace vernier::localise;
using namespace vernier::sim;

CornerDrive office_drive(const SourceSettings& sources,
                         std::uint64_t seed = 1,
                         std::uint32_t trial = 0) {
  std::vector<Pose2D> poses = drive_poses(test::small_office().route.front(), 0.2, 0.08);
  if (poses.size() > 12) poses.resize(12);
  return drive_past_corners(test::small_office_visibility(), test::nominal_rig().rig, sources,
                            {.height_m = 1.2}, poses, seed, trial);
}

TEST(CornerAppearance, RepeatsWithTheTemplate) {
  const World& world = test::small_office();
  const CornerAppearance appearance(world);
  std::map<std::string, std::vector<std::vector<std::uint32_t>>> corners_of;
  for (std::size_t o = 0; o < world.objects.size(); ++o) {
    auto& objects = corners_of[world.objects[o].template_name];
    objects.emplace_back();
    for (std::uint32_t c = 0; c < world.corners.size(); ++c) {
      if (world.corners[c].object == static_cast<std::int32_t>(o)) objects.back().push_back(c);
    }
  }
  int repeated = 0;
  for (const auto& [name, objects] : corners_of) {
    for (std::size_t i = 1; i < objects.size(); ++i) {
      ASSERT_EQ(objects[i].size(), objects[0].size()) << name;
      for (std::size_t k = 0; k < objects[i].size(); ++k, ++repeated) {
        EXPECT_EQ(appearance.of(objects[i][k]), appearance.of(objects[0][k])) << name;
      }
    }
    for (std::size_t k = 1; k < objects[0].size(); ++k) {
      EXPECT_LT(appearance.of(objects[0][k]).dot(appearance.of(objects[0][0])), 0.9F) << name;
    }
  }
  EXPECT_GT(repeated, 50);
}

/// Two instances of a template, one turned by a quarter, and the same corner twice as loose ones.
World two_desks() {
  WorldDescription description;
  WorldTemplate desk{"desk", {}};
  for (int i = 0; i < 20; ++i) {
    desk.features.corners_m.emplace_back(0.05 * i, 0.4, 0.7);
  }
  description.templates = {desk};
  description.instances = {{"desk", {1, 2, 0}, 0}, {"desk", {7, -3, 0}, 1.5707963267948966}};
  description.loose.corners_m = {{4, 4, 1}, {4, 4, 1}};
  return build_world(description);
}

TEST(CornerAppearance, OfTwoInstancesIsTheSameFromTheSameSide) {
  const World world = two_desks();
  const CornerAppearance appearance(world, {.view_change = 1});
  const SensingDraw draw{};
  const Eigen::Matrix3d quarter = rotation_from_vector({0, 0, 1.5707963267948966});
  double across = 0;
  for (std::uint32_t c = 0; c < 20; ++c) {
    const std::uint32_t first = 2 + c, second = 22 + c;  // loose corners come first
    const Eigen::Vector3d to_eye(1.5, -2, 0.5);
    const Eigen::Vector3d at = world.corners[first].position_m;
    const Eigen::Vector3d other = world.corners[second].position_m;
    const Eigen::VectorXf seen = appearance.seen(first, at + to_eye, draw);
    EXPECT_NEAR(seen.norm(), 1, 1e-6);
    EXPECT_LT((appearance.seen(second, other + quarter * to_eye, draw) - seen).norm(), 1e-5);
    across += appearance.seen(first, at + quarter * to_eye, draw).dot(seen) / 20;
  }
  EXPECT_NEAR(across, 0.5, 0.15);                           // (1 + v² cos 90°) / (1 + v²)
  EXPECT_LT(appearance.of(0).dot(appearance.of(1)), 0.9F);  // loose: each its own
}

TEST(CornerAppearance, NoiseIsOfTheStatedSizeAndOfEachSightingAlone) {
  const World world = two_desks();
  const CornerAppearance exact(world), noisy(world, {.noise = 0.5});
  const Eigen::Vector3d eye(0, 0, 1.2);
  double similarity = 0;
  for (std::uint32_t frame = 0; frame < 200; ++frame) {
    const SensingDraw now{.seed = 5, .trial = 1, .frame = frame};
    const SensingDraw later{.seed = 5, .trial = 2, .frame = frame};
    EXPECT_EQ(exact.seen(3, eye, now), exact.of(3));
    EXPECT_EQ(noisy.seen(3, eye, now), noisy.seen(3, eye, now));
    similarity += noisy.seen(3, eye, now).dot(noisy.seen(3, eye, later)) / 200;
  }
  EXPECT_NEAR(similarity, 1 / (1 + 0.25), 0.03);  // standard error 0.006
  EXPECT_ANY_THROW(CornerAppearance(world, {.noise = -1}));
  EXPECT_ANY_THROW(CornerAppearance(world, {.view_change = 101}));
}

TEST(CornerDrive, WithoutErrorsItIsFollowedExactly) {
  const CornerDrive seen = office_drive(no_sources());
  const OdometryPath path = odometry_path(test::nominal_rig().rig, seen.moments);
  int found = 0;
  for (std::size_t i = 0; i < path.steps.size(); ++i) {
    if (!path.steps[i]) continue;
    ++found;
    const Pose off = path.steps[i]->T_from_to.inverse() *
                     (seen.T_world_left[i].inverse() * seen.T_world_left[i + 1]);
    EXPECT_LT(off.t.norm() + vector_from_rotation(off.R).norm(), 1e-6);
  }
  EXPECT_GT(found, 5);
}

TEST(CornerDrive, NoiseHasTheStatedStandardDeviation) {
  SourceSettings noisy = no_sources();
  noisy.corner_sigma_px = 0.3;
  const CornerDrive seen = office_drive(noisy), exact = office_drive(no_sources());
  double sum = 0;
  int values = 0;
  for (std::size_t i = 0; i < seen.moments.size(); ++i) {
    ASSERT_EQ(seen.moments[i].size(), exact.moments[i].size());
    for (std::size_t k = 0; k < seen.moments[i].size(); ++k, values += 4) {
      sum += (seen.moments[i][k].left_px - exact.moments[i][k].left_px).squaredNorm() +
             (seen.moments[i][k].right_px - exact.moments[i][k].right_px).squaredNorm();
      EXPECT_EQ(seen.moments[i][k].covariance_px2, 0.09 * Eigen::Matrix4d::Identity());
    }
  }
  // Seed fixed; the estimate's standard deviation is 0.3 px / √(2 · 500) or less.
  ASSERT_GT(values, 500);
  EXPECT_NEAR(std::sqrt(sum / values), 0.3, 0.03);
}

// 80 drives, each with a rig of its own: their ends' squared errors are a chi2 with 480 degrees of
// freedom, both tails at 5e-5. The calibration's distance between a corner's pixels and its point's
// enlarges chi2 / dof and so the covariance, by which the lower bound is wider: 0.7 times.
TEST(CornerDrive, TheEndsErrorIsThatOfTheCornersAndTheCalibration) {
  SourceSettings noisy = no_sources();
  noisy.corner_sigma_px = 0.15;
  const RigEstimate& nominal = test::nominal_rig();
  const RigSampler sampler(nominal);
  StepOptions options;
  options.calibration = nominal.covariance->matrix;
  constexpr std::uint32_t drives = 80;
  double sum = 0;
  for (std::uint32_t trial = 0; trial < drives; ++trial) {
    const CornerDrive seen = office_drive(noisy, 3, trial);
    const OdometryPath path =
        odometry_path(sampler.sample(1, 4, trial), seen.moments, CornerLinkOptions{}, options);
    for (const auto& step : path.steps) ASSERT_TRUE(step);
    const Pose truth = seen.T_world_left.front().inverse() * seen.T_world_left.back();
    MotionStep end;
    end.T_from_to = path.T_first_camera.back();
    end.covariance = path.end_covariance;
    end.by_rig = path.end_by_rig;
    sum += step_nees(end, truth, options.calibration);
  }
  using vernier::internal::chi_squared_quantile;
  EXPECT_GT(sum, 0.7 * chi_squared_quantile(5e-5, 6 * drives));
  EXPECT_LT(sum, chi_squared_quantile(1 - 5e-5, 6 * drives));
}

TEST(CornerDrive, TheSameSeedGivesTheSameDrive) {
  const CornerDrive a = office_drive(SourceSettings()), b = office_drive(SourceSettings()),
                    c = office_drive(SourceSettings(), 2);
  ASSERT_EQ(a.moments.size(), b.moments.size());
  bool differs = false;
  for (std::size_t i = 0; i < a.moments.size(); ++i) {
    ASSERT_EQ(a.moments[i].size(), b.moments[i].size());
    differs = differs || a.moments[i].size() != c.moments[i].size();
    for (std::size_t k = 0; k < a.moments[i].size(); ++k) {
      EXPECT_EQ(a.moments[i][k].left_px, b.moments[i][k].left_px);
      EXPECT_EQ(a.moments[i][k].right_px, b.moments[i][k].right_px);
    }
  }
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace vernier
