// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/noise_free_view.h"

#include <gtest/gtest.h>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/route.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/world.h"
#include "stereo/reconstruction/triangulate.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"
#include "tests/support/small_office.h"

namespace vernier {

using namespace vernier::sim::internal;
using namespace vernier::localise;
using namespace vernier::sim;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

double distance_to_segment(const Eigen::Vector3d& x, const WorldSegment& s) {
  const Eigen::Vector3d d = s.b_m - s.a_m;
  const double t = std::clamp((x - s.a_m).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (s.a_m + t * d - x).norm();
}

TEST(NoiseFreeView, AllSourcesOffAndTheTrueRigToldPutSegmentsBackOnTheWorld) {
  const World& world = test::small_office();
  const Rig& rig = test::nominal_rig().rig;
  const Sensor sensor(rig, no_sources());
  int checked = 0;
  for (const Pose2D& pose : map_poses(world.route, 1.5)) {
    const NoiseFreeView seen = look(test::small_office_visibility(), rig, pose);
    const StereoObservation sighting = sensor.sense(seen, 1, 0, 0);
    ASSERT_EQ(sighting.segments.size(), seen.edges.size());
    const Pose T_world_left = T_left_world(pose, {}).inverse();
    for (std::size_t i = 0; i < sighting.segments.size(); ++i) {
      const SpaceSegment placed = triangulate(rig, sighting.segments[i]);
      const WorldSegment& truth = world.segments[seen.edges[i].segment];
      // An edge along its epipolar line spans no plane with the right eye: stereo cannot place it.
      const Rectification r = rectification(rig);
      if (epipolar_angle_rad(rig, r, sighting.segments[i].left) < 1e-3) continue;
      EXPECT_LT(distance_to_segment(T_world_left * placed.a_m, truth), 1e-9);
      EXPECT_LT(distance_to_segment(T_world_left * placed.b_m, truth), 1e-9);
      ++checked;
    }
  }
  EXPECT_GT(checked, 300);
}

TEST(NoiseFreeView, EdgesAreWhatBothEyesSee) {
  const Rig& rig = test::nominal_rig().rig;
  const Pose2D pose = map_poses(test::small_office().route, 2)[3];
  const Pose T_left = T_left_world(pose, {});
  for (const VisibleEdge& edge : look(test::small_office_visibility(), rig, pose).edges) {
    const Eigen::Vector3d middle = T_left.inverse() * (0.5 * (edge.a_m + edge.b_m));
    for (int eye = 0; eye < 2; ++eye) {
      const Pose T_eye = rig.T_camera_first[eye] * T_left;
      const Eigen::Vector3d centre = T_eye.inverse().t;
      EXPECT_TRUE(test::small_office_visibility().sees(centre, middle));
      EXPECT_TRUE(in_image(rig.cameras[eye], project(rig.cameras[eye], T_eye * middle)));
    }
  }
}

TEST(NoiseFreeView, TheCameraStandsWhereTheMountSays) {
  const Pose T_world_left = T_left_world({3, 4, 1.5707963267948966}, {1.2, 0}).inverse();
  EXPECT_LT((T_world_left.t - Eigen::Vector3d(3, 4, 1.2)).norm(), 1e-12);
  EXPECT_LT((T_world_left * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(3, 5, 1.2)).norm(), 1e-12);
  EXPECT_LT((T_world_left * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(4, 4, 1.2)).norm(), 1e-12);
}

}  // namespace
}  // namespace vernier
