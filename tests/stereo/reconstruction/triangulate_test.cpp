// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/reconstruction/triangulate.h"

#include <gtest/gtest.h>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig.h"
#include "stereo/segment.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

ImageSegment seen_by(const Rig& rig,
                     int camera,
                     const Eigen::Vector3d& a,
                     const Eigen::Vector3d& b) {
  const auto pixel = [&](const Eigen::Vector3d& x) {
    return project(rig.cameras[camera], rig.T_camera_first[camera] * x);
  };
  return {pixel(a), pixel(b)};
}

class Triangulate : public testing::TestWithParam<const char*> {
 protected:
  Rig rig_ = test::stereo_rig(camera_model(GetParam()));
};

TEST_P(Triangulate, GivesTheSegmentBack) {
  const Eigen::Vector3d a(-0.4, 0.5, 2.0), b(0.3, -0.6, 3.1);
  const SpaceSegment s = triangulate(rig_, {seen_by(rig_, 0, a, b), seen_by(rig_, 1, a, b), 0});
  EXPECT_TRUE(s.reliable);
  EXPECT_LT((s.a_m - a).norm(), 1e-9);
  EXPECT_LT((s.b_m - b).norm(), 1e-9);
}

TEST_P(Triangulate, RightEndPointsNeedNotCorrespond) {
  const Eigen::Vector3d a(-0.4, 0.5, 2.0), b(0.3, -0.6, 3.1), d = b - a;
  const SpaceSegment s =
      triangulate(rig_, {seen_by(rig_, 0, a, b), seen_by(rig_, 1, a + 0.2 * d, b - 0.3 * d), 0});
  EXPECT_LT((s.a_m - a).norm(), 1e-9);
  EXPECT_LT((s.b_m - b).norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Models,
                         Triangulate,
                         testing::Values("pinhole", "radial1", "opencv5", "fisheye4"));

TEST(TriangulateDoubt, NegativeDisparityIsUnreliableAndFinite) {
  const Rig rig = test::stereo_rig();
  const Eigen::Vector3d a(0.1, -0.4, 4), b(0.1, 0.4, 4);
  StereoSegment pair{seen_by(rig, 0, a, b), seen_by(rig, 1, a, b), 0};
  pair.right.a_px.x() += 60;
  pair.right.b_px.x() += 60;
  const SpaceSegment s = triangulate(rig, pair);
  EXPECT_FALSE(s.reliable);
  EXPECT_TRUE(s.a_m.allFinite());
  EXPECT_EQ(s.a_m.z(), TriangulationOptions{}.max_depth_m);
}

TEST(TriangulateDoubt, DepthSigmaGrowsWithTheSquareOfDepthAndForFlatLines) {
  const Rig rig = test::stereo_rig();
  const auto sigma = [&](double depth, double slope) {
    const Eigen::Vector3d a(-0.1, -0.1 * slope, depth), b(0.1, 0.1 * slope, depth);
    return triangulate(rig, {seen_by(rig, 0, a, b), seen_by(rig, 1, a, b), 0}).depth_sigma_m;
  };
  EXPECT_NEAR(sigma(4, 10) / sigma(2, 10), 4, 0.2);
  EXPECT_GT(sigma(2, 0.2), 3 * sigma(2, 10));
}

TEST(TriangulateDoubt, OneCameraIsRefused) {
  Rig rig = test::stereo_rig();
  rig.cameras.pop_back();
  rig.T_camera_first.pop_back();
  EXPECT_THROW(triangulate(rig, StereoSegment{}), Error);
}

}  // namespace
}  // namespace vernier
