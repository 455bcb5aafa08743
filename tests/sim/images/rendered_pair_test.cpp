// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/images/rendered_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/camera.h"
#include "calib/statistics/random.h"
#include "sim/images/image_truth.h"
#include "sim/noise_free_view.h"
#include "stereo/rectification.h"
#include "tests/support/small_office.h"

namespace vernier::test {

using vernier::internal::RandomStream;
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The nominal rig, with its right camera turned by a few degrees.
Rig crooked_rig() {
  Rig rig = nominal_rig().rig;
  rig.T_camera_first[1].R = rotation_from_vector({0.02, -0.03, 0.015}) * rig.T_camera_first[1].R;
  return rig;
}

struct Made {
  Rig rig = crooked_rig();
  ImageScene scene = image_scene(small_office());
  Pose T_left = T_left_world(map_poses(small_office().route, 2)[2], {});
  RectifiedView view = rectified_view(rig, stereo::rectified_geometry(rig), T_left);
};

TEST(PairTruth, DisparityIsThatOfTheDepthSeenByTheRig) {
  const Made made;
  const PairTruth truth = pair_truth(made.scene, made.rig, made.view, 1);
  RandomStream draws({.seed = 8});
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const int x = static_cast<int>(draws.below(640)), y = static_cast<int>(draws.below(480));
    if (!truth.left.known(x, y)) continue;
    const double z = truth.left_depth_m[static_cast<std::size_t>(640 * y + x)];
    // To the raw left image, out along its ray, to the raw right image, and back to its rectified
    // one.
    const auto raw = stereo::raw_pixel(made.rig, made.view.geometry, 0, Vector2d(x, y));
    ASSERT_TRUE(raw.has_value());
    const Vector3d ray = unproject(made.rig.cameras[0], *raw);
    const double along = (made.view.geometry.turn.R_rectified_left * ray).z();
    const Vector3d point = ray * (z / along);
    const Vector3d right = made.rig.T_camera_first[1] * point;
    if (right.z() < 0.05) continue;
    const auto other = stereo::rectified_pixel(made.rig, made.view.geometry, 1,
                                               project(made.rig.cameras[1], right));
    ASSERT_TRUE(other.has_value());
    EXPECT_NEAR(other->y(), y, 1e-6);
    EXPECT_NEAR(x - other->x(), truth.left(x, y), 2e-5 * truth.left(x, y) + 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 2000);
}

TEST(PairTruth, BothEyesAgreeWhereBothSee) {
  const Made made;
  const PairTruth truth = pair_truth(made.scene, made.rig, made.view, 1);
  int agree = 0, nearer = 0, farther = 0;
  for (int y = 3; y < 477; y += 5) {
    for (int x = 3; x < 637; x += 5) {
      if (!truth.left.known(x, y)) continue;
      const double d = truth.left(x, y);
      const int other = static_cast<int>(std::lround(x - d));
      if (other < 0 || other >= 640 || !truth.right.known(other, y)) continue;
      const double difference = truth.right(other, y) - d;
      ++(std::abs(difference) < 1 ? agree : difference > 0 ? nearer : farther);
    }
  }
  // What the right eye sees there is nearer, where it does not see the left one's point; farther
  // only beside an edge.
  EXPECT_GT(agree, 20 * farther);
  EXPECT_GT(agree, 5000);
  EXPECT_GT(nearer, farther);
}

TEST(RenderedPair, RepeatsToTheBitForAnyNumberOfThreads) {
  const Made made;
  PairOptions options;
  const RenderedPair one = rendered_pair(made.scene, made.rig, made.rig, made.view.geometry,
                                         made.T_left, options, {3, 2, 0});
  options.render.threads = 8;
  const RenderedPair again = rendered_pair(made.scene, made.rig, made.rig, made.view.geometry,
                                           made.T_left, options, {3, 2, 0});
  EXPECT_EQ(one.left.values, again.left.values);
  EXPECT_EQ(one.right.values, again.right.values);
  EXPECT_EQ(one.rectified.pair.left.values, again.rectified.pair.left.values);
  EXPECT_EQ(one.without_noise.right.values, again.without_noise.right.values);
  EXPECT_EQ(one.exposure, again.exposure);
}

TEST(RenderedPair, CorrespondingPixelsLookAlike) {
  const Made made;
  const RenderedPair pair =
      rendered_pair(made.scene, made.rig, made.rig, made.view.geometry, made.T_left, {}, {});
  const PairTruth truth = pair_truth(made.scene, made.rig, made.view, 1);
  std::vector<double> differences;
  for (int y = 5; y < 475; ++y) {
    for (int x = 5; x < 635; ++x) {
      if (!truth.left.known(x, y)) continue;
      const auto other = static_cast<int>(std::lround(x - truth.left(x, y)));
      if (other < 1 || other > 638 || !truth.right.known(other, y)) continue;
      if (std::abs(truth.right(other, y) - truth.left(x, y)) > 0.5) continue;
      differences.push_back(
          std::abs(pair.without_noise.left(x, y) - pair.without_noise.right(other, y)));
    }
  }
  ASSERT_GT(differences.size(), 100'000U);
  std::nth_element(differences.begin(), differences.begin() + differences.size() / 2,
                   differences.end());
  // Texture of 2 % at half a pixel, and vignetting: it depends on the reflectances that were drawn.
  EXPECT_LT(differences[differences.size() / 2], 4);
}

}  // namespace
}  // namespace vernier::test
