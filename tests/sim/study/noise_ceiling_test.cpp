// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/noise_ceiling.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "calib/error.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/study/view_likelihood.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "tests/support/small_office.h"
#include "tests/support/twin_rooms.h"

namespace vernier {

using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

// The noise moves no edge by more than 5 px: a pose 0.3 m or 5 degrees away explains a look worse.
TEST(ViewLikelihood, IsLowerAtOtherPoses) {
  const Rig& rig = test::nominal_rig().rig;
  const Visibility& visibility = test::small_office_visibility();
  const ViewLikelihood likelihood(rig, {});
  const Sensor sensor(rig, {});
  for (const Pose2D& pose : map_poses(test::small_office().route, 2)) {
    const NoiseFreeView here = look(visibility, rig, pose);
    if (here.edges.size() < 10) continue;
    const auto sensed = sensor.sense(here, {.seed = 3}).segments;
    const double at_truth = likelihood.log_likelihood(sensed, here);
    for (const Pose2D& step : {Pose2D{0.3, 0, 0}, Pose2D{0, -0.3, 0}, Pose2D{0, 0, 0.09}}) {
      const NoiseFreeView there = look(visibility, rig, compose(pose, step));
      EXPECT_GT(at_truth, likelihood.log_likelihood(sensed, there)) << pose.x_m << ' ' << pose.y_m;
    }
  }
}

TEST(ViewLikelihood, RefusesShiftsThatItDoesNotKnow) {
  SourceSettings sources;
  sources.lateral_shift_mode = ShiftMode::independent;
  EXPECT_THROW(ViewLikelihood(test::nominal_rig().rig, sources), Error);
}

/// Right looks among 30 from one pose.
int right_looks(const World& world) {
  const Visibility visibility(world);
  const NoiseCeiling ceiling(visibility, test::nominal_rig().rig, {}, {});
  int right = 0;
  for (std::uint32_t trial = 0; trial < 30; ++trial) {
    right += ceiling.look_from({2, 1, 1.5}, {.seed = 9, .trial = trial}).right();
  }
  return right;
}

// In twin rooms either is the likelier one by chance: at most half of the looks are right, ties
// being wrong. P(more than 27 of 30 heads) < 1e-6. A further cupboard tells the rooms apart.
TEST(NoiseCeiling, CannotTellTwinRoomsButForACupboard) {
  EXPECT_LE(right_looks(test::twin_rooms(false)), 27);
  EXPECT_EQ(right_looks(test::twin_rooms(true)), 30);
}

}  // namespace
}  // namespace vernier
