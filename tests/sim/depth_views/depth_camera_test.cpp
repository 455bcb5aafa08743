// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/depth_views/depth_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/statistics/distributions.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "localise/views/depth_view.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "tests/support/error_message.h"

namespace vernier::sim::internal {
namespace {

using Eigen::Vector3d;
using localise::internal::DepthSegments;
using localise::internal::level_pose;
using localise::internal::LevelPose;
using stereo::internal::SegmentStatus;
using vernier::internal::RandomStream;

Camera depth_pinhole() {
  Camera camera;
  camera.model = Pinhole{};
  camera.parameters = Eigen::Vector4d(500, 1.02, 322, 241);
  return camera;
}

/// A grid of lines, level and upright, on a wall 4 m ahead of the origin.
World wall() {
  WorldDescription description;
  for (int i = -4; i <= 4; ++i) {
    description.loose.segments_m.push_back({{4, 0.25 * i, 0.8}, {4, 0.25 * i, 1.6}});
    description.loose.segments_m.push_back({{4, -1, 1.2 + 0.1 * i}, {4, 1, 1.2 + 0.1 * i}});
  }
  return build_world(description);
}

SourceSettings only_ends() {
  SourceSettings settings = no_sources();
  settings.endpoint_sigma_px = 0.3;
  settings.epipolar_reject_deg = 0;
  return settings;
}

NoiseFreeViewOptions tilted() {
  NoiseFreeViewOptions how;
  how.mount = {1.25, 0.1};
  how.roll_rad = 0.2;
  return how;
}

TEST(DepthCamera, LooksAsAnyPoseDoes) {
  for (std::uint32_t i = 0; i < 50; ++i) {
    RandomStream draws({.seed = 2, .feature = i});
    const Pose T_world_camera{rotation_from_vector(2 * draws.normals(3)),
                              Vector3d(draws.normals(3)) + Vector3d(0, 0, 9)};
    const LevelPose level = level_pose(T_world_camera, 2, 1, "pose");
    const CameraTurn turn = turn_of(level.R_level_camera);
    const Pose T = T_left_world(level.pose, {level.height_m, turn.pitch_rad}, turn.roll_rad);
    EXPECT_LT((T.R - T_world_camera.R.transpose()).norm(), 1e-9);
    EXPECT_LT((T.inverse().t - T_world_camera.t).norm(), 1e-9);
  }
}

TEST(DepthCamera, WithoutSourcesSeesWhatIsThere) {
  const World world = wall();
  const Visibility visibility(world);
  SourceSettings settings = no_sources();
  settings.epipolar_reject_deg = 0;
  const DepthCameraSensor sensor(depth_pinhole(), 1.5e-3, settings);
  const NoiseFreeViewOptions how = tilted();
  const DepthSegments seen = sensor.sense(visibility, {}, how, {});
  EXPECT_EQ(seen.image.size(), world.segments.size());
  const Pose T_world_camera = T_left_world({}, how.mount, how.roll_rad).inverse();
  for (const auto& s : seen.in_space) {
    ASSERT_EQ(s.status, SegmentStatus::placed);
    EXPECT_NEAR((T_world_camera * s.segment.a_m).x(), 4, 1e-9);
    EXPECT_NEAR((T_world_camera * s.segment.b_m).x(), 4, 1e-9);
    EXPECT_TRUE(s.segment.reliable);
  }
}

TEST(DepthCamera, DepthsErrAsStated) {
  // 1 of 1,000 seeds on either side
  const World world = wall();
  const Visibility visibility(world);
  constexpr double per_m2 = 2e-3;
  const DepthCameraSensor sensor(depth_pinhole(), per_m2, only_ends());
  EXPECT_NEAR(sensor.baseline_m(), 0.3 / (510 * per_m2), 1e-12);
  const Pose T_camera_world = T_left_world({}, tilted().mount, tilted().roll_rad);
  const Vector3d normal = T_camera_world.R * Vector3d::UnitX();
  const double wall_m = 4 + normal.dot(T_camera_world.t);
  double chi2 = 0;
  int count = 0;
  for (std::uint32_t frame = 0; frame < 40; ++frame) {
    const DepthSegments seen = sensor.sense(visibility, {}, tilted(), {.seed = 4, .frame = frame});
    for (const auto& s : seen.in_space) {
      // the ray of an end meets the wall at a depth that is known whatever the pixel's error
      const Vector3d ray = s.segment.a_m / s.segment.a_m.z();
      const double true_z = wall_m / normal.dot(ray);
      const double sigma = per_m2 * true_z * true_z;
      const double z = (s.segment.a_m.z() - true_z) / sigma;
      EXPECT_NEAR(s.segment.depth_sigma_m / sigma, 1, 0.1);
      // both ends are on one side of the wall
      const Vector3d other = s.segment.b_m / s.segment.b_m.z();
      const double b = (s.segment.b_m.z() - wall_m / normal.dot(other)) / sigma;
      EXPECT_NEAR(z, b, 0.1 + 0.2 * std::abs(z));
      chi2 += z * z;
      ++count;
    }
  }
  EXPECT_GT(chi2, vernier::internal::chi_squared_quantile(0.001, count));
  EXPECT_LT(chi2, 1.05 * vernier::internal::chi_squared_quantile(0.999, count));  // not linear
}

TEST(DepthCamera, DrawsAreThoseOfTheViewAndTheSource) {
  const World world = wall();
  const Visibility visibility(world);
  SourceSettings with_loss = only_ends();
  with_loss.stereo_mismatch = 0.3;
  const DepthCameraSensor plain(depth_pinhole(), 2e-3, only_ends()),
      lossy(depth_pinhole(), 2e-3, with_loss);
  const auto seen = [&](const DepthCameraSensor& sensor, std::uint32_t frame) {
    return sensor.sense(visibility, {}, tilted(), {.seed = 4, .frame = frame});
  };
  const DepthSegments one = seen(plain, 1), again = seen(plain, 1), other = seen(plain, 2);
  const DepthSegments wrong = seen(lossy, 1);
  ASSERT_EQ(one.image.size(), wrong.image.size());
  int same = 0;
  for (std::size_t i = 0; i < one.image.size(); ++i) {
    EXPECT_EQ(one.in_space[i].segment.a_m, again.in_space[i].segment.a_m);
    EXPECT_NE(one.image[i].a_px, other.image[i].a_px);
    EXPECT_EQ(one.image[i].a_px, wrong.image[i].a_px);
    same += one.in_space[i].segment.a_m == wrong.in_space[i].segment.a_m;
  }
  EXPECT_GT(same, 8);
  EXPECT_LT(same, static_cast<int>(one.image.size()));
}

TEST(DepthCamera, RefusesALensWithDistortion) {
  Camera camera = depth_pinhole();
  camera.model = Radial1{};
  camera.parameters.conservativeResize(5);
  camera.parameters[4] = 0.1;
  EXPECT_NE(test::error_message([&] { DepthCameraSensor(camera, 1e-3, {}); }).find("distortion"),
            std::string::npos);
  EXPECT_NE(
      test::error_message([] { DepthCameraSensor(depth_pinhole(), 0, {}); }).find("depth error"),
      std::string::npos);
}

}  // namespace
}  // namespace vernier::sim::internal
