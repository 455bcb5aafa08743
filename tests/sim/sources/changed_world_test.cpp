// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <set>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/mount_error.h"
#include "sim/moved_furniture.h"
#include "sim/noise_free_view.h"
#include "sim/sources.h"
#include "sim/world.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim;
using namespace vernier::localise;

namespace {

constexpr double degree = std::numbers::pi / 180;

SourceSettings mount_errors(double height_m, double pitch_deg, double roll_deg) {
  SourceSettings settings = no_sources();
  settings.mount_height_m = height_m;
  settings.mount_pitch_deg = pitch_deg;
  settings.mount_roll_deg = roll_deg;
  return settings;
}

TEST(MountError, IsNothingAtZeroAndProportionalToItsSize) {
  const CameraMount told{1.3, 0.1};
  const TrueMount none = draw_mount(told, no_sources(), 5, 3);
  EXPECT_EQ(none.mount.height_m, told.height_m);
  EXPECT_EQ(none.mount.pitch_rad, told.pitch_rad);
  EXPECT_EQ(none.roll_rad, 0);
  const TrueMount one = draw_mount(told, mount_errors(0.01, 1, 0.5), 5, 3),
                  two = draw_mount(told, mount_errors(0.02, 2, 1), 5, 3);
  EXPECT_NE(one.mount.height_m, told.height_m);
  EXPECT_NEAR(two.mount.height_m - 1.3, 2 * (one.mount.height_m - 1.3), 1e-12);
  EXPECT_NEAR(two.mount.pitch_rad - 0.1, 2 * (one.mount.pitch_rad - 0.1), 1e-12);
  EXPECT_NEAR(two.roll_rad, 2 * one.roll_rad, 1e-12);
}

TEST(MountError, SwitchesOneByOne) {
  const CameraMount told{1.3, 0.1};
  const TrueMount all = draw_mount(told, mount_errors(0.01, 1, 0.5), 5, 3),
                  height = draw_mount(told, mount_errors(0.01, 0, 0), 5, 3),
                  pitch = draw_mount(told, mount_errors(0, 1, 0), 5, 3),
                  roll = draw_mount(told, mount_errors(0, 0, 0.5), 5, 3),
                  other = draw_mount(told, mount_errors(0.01, 1, 0.5), 5, 4);
  EXPECT_EQ(height.mount.height_m, all.mount.height_m);
  EXPECT_EQ(height.mount.pitch_rad, 0.1);
  EXPECT_EQ(pitch.mount.pitch_rad, all.mount.pitch_rad);
  EXPECT_EQ(pitch.mount.height_m, 1.3);
  EXPECT_EQ(pitch.roll_rad, 0);
  EXPECT_EQ(roll.roll_rad, all.roll_rad);
  EXPECT_EQ(roll.mount.height_m, 1.3);
  EXPECT_NE(other.roll_rad, all.roll_rad);
}

TEST(MountError, LeavesTheCameraAboveTheFloorAndBelowTheVertical) {
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    const TrueMount stands = draw_mount({0.1, 80 * degree}, mount_errors(1, 30, 0), 5, trial);
    EXPECT_GE(stands.mount.height_m, 0.01);
    EXPECT_LE(std::abs(stands.mount.pitch_rad), 89 * degree + 1e-12);
  }
}

/// A camera that rolls clockwise turns the image counter-clockwise about its centre.
TEST(MountError, RollTurnsTheImage) {
  const Pose2D pose{1, 2, 0.3};
  const CameraMount mount{1.2, 0.2};
  const Pose level = T_left_world(pose, mount), rolled = T_left_world(pose, mount, 0.1);
  EXPECT_EQ(level.R, T_left_world(pose, mount, 0).R);
  const Eigen::Vector3d ahead(1, 0, 4);  // right of the middle, in the level camera
  const Eigen::Vector3d seen = rolled * (level.inverse() * ahead);
  EXPECT_NEAR(seen.z(), 4, 1e-12);
  EXPECT_NEAR(seen.x(), std::cos(0.1), 1e-12);
  EXPECT_NEAR(seen.y(), -std::sin(0.1), 1e-12);  // up
  NoiseFreeViewOptions options;
  options.roll_rad = 0.1;
  const NoiseFreeView turned = look(test::small_office_visibility(), test::nominal_rig().rig,
                                    test::office_look().pose, options);
  EXPECT_GT(turned.edges.size(), test::office_look().edges.size() / 2);
}

/// The objects that are not where they were.
std::set<std::int32_t> moved_objects(const World& before, const World& after) {
  std::set<std::int32_t> moved;
  for (std::size_t i = 0; i < before.objects.size(); ++i) {
    if (before.objects[i].yaw_rad != after.objects[i].yaw_rad) {
      moved.insert(static_cast<std::int32_t>(i));
    }
  }
  return moved;
}

TEST(MovedFurniture, IsRigidOnTheFloorAndLeavesTheBuilding) {
  const World& before = test::small_office();
  const World after = with_moved_furniture(before, 1, 5);
  const std::set<std::int32_t> moved = moved_objects(before, after);
  for (std::size_t i = 0; i < before.objects.size(); ++i) {
    const bool stays = i == 0 || is_fixture(before.objects[i].template_name);
    EXPECT_EQ(moved.contains(static_cast<std::int32_t>(i)), !stays)
        << before.objects[i].template_name;
  }
  EXPECT_GT(moved.size(), 10u);
  EXPECT_LT(moved.size(), before.objects.size());
  ASSERT_EQ(before.segments.size(), after.segments.size());
  for (std::size_t i = 0; i < before.segments.size(); ++i) {
    const WorldSegment &from = before.segments[i], &to = after.segments[i];
    EXPECT_NEAR((from.b_m - from.a_m).norm(), (to.b_m - to.a_m).norm(), 1e-9);
    EXPECT_EQ(from.a_m.z(), to.a_m.z());
    if (!moved.contains(from.object)) {
      EXPECT_EQ(from.a_m, to.a_m);
      EXPECT_EQ(from.b_m, to.b_m);
      continue;
    }
    // Turned as its object says it is.
    const double turn = after.objects[from.object].yaw_rad - before.objects[from.object].yaw_rad;
    EXPECT_LE(std::abs(turn), 0.8);
    const Eigen::Vector3d d = from.b_m - from.a_m, e = to.b_m - to.a_m;
    EXPECT_NEAR(e.x(), std::cos(turn) * d.x() - std::sin(turn) * d.y(), 1e-9);
  }
  for (std::size_t i = 0; i < before.surfaces.size(); ++i) {
    const auto &from = before.surfaces[i], &to = after.surfaces[i];
    EXPECT_EQ(from.polygon_m[0] != to.polygon_m[0], moved.contains(from.object));
  }
  EXPECT_NO_THROW(Visibility{after});
}

TEST(MovedFurniture, OfALargerShareIsASupersetAndMovesAlike) {
  const World& before = test::small_office();
  const World none = with_moved_furniture(before, 0, 5), few = with_moved_furniture(before, 0.2, 5),
              many = with_moved_furniture(before, 0.6, 5),
              other = with_moved_furniture(before, 0.2, 6);
  EXPECT_TRUE(moved_objects(before, none).empty());
  const auto little = moved_objects(before, few), much = moved_objects(before, many);
  EXPECT_GT(little.size(), 0u);
  EXPECT_GT(much.size(), little.size());
  for (const std::int32_t object : little) {
    EXPECT_TRUE(much.contains(object));
    EXPECT_EQ(few.objects[object].centre_m, many.objects[object].centre_m);
  }
  EXPECT_NE(moved_objects(before, other), little);
}

}  // namespace
}  // namespace vernier
