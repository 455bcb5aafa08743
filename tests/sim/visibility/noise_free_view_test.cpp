// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/noise_free_view.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/visibility/stretch_feature.h"
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
    const StereoObservation sighting = sensor.sense(seen);
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

TEST(NoiseFreeView, StretchesKeepTheirNumbersAndShareNone) {
  EXPECT_EQ(stretch_feature(0, 0, 7), 0u);
  EXPECT_EQ(stretch_feature(6, 31, 7), 6 * 32 + 31u);
  std::set<std::uint32_t> numbers;
  for (int segment = 0; segment < 7; ++segment) {
    for (int run = 0; run < 100; ++run) {
      EXPECT_TRUE(numbers.insert(stretch_feature(segment, run, 7)).second) << segment << " " << run;
    }
  }
  EXPECT_EQ(stretch_feature(67108863, 31, 67108864), 0x7fffffffu);
  EXPECT_THROW(stretch_feature(0, 32, 67108864), Error);
}

/// An edge 4 m ahead behind 44 posts.
World fence() {
  WorldDescription description;
  description.loose.segments_m.push_back({{4, 2.4, 1.2}, {4, -2.4, 1.2}});
  for (int post = 0; post < 44; ++post) {
    const double y = 2.2 - 0.1 * post;
    description.loose.surfaces_m.push_back(
        {{3.9, y, 1}, {3.9, y - 0.02, 1}, {3.9, y - 0.02, 1.4}, {3.9, y, 1.4}});
  }
  return build_world(description);
}

TEST(NoiseFreeView, AnEdgeBehindAFenceHasAFeatureForEveryGap) {
  const World world = fence();
  const Visibility visibility(world);
  NoiseFreeViewOptions options;
  options.visibility.min_length_px = 2;
  const NoiseFreeView seen = look(visibility, test::nominal_rig().rig, {0, 0, 0}, options);
  ASSERT_GT(seen.edges.size(), 35u);
  std::set<std::uint32_t> numbers;
  for (const VisibleEdge& edge : seen.edges) {
    EXPECT_EQ(edge.segment, 0);
    EXPECT_TRUE(numbers.insert(edge.feature).second) << edge.feature;
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
