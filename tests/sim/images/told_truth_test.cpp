// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
// Ground truth of pairs that a wrong rig rectifies.
#include "sim/images/told_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "sim/images/depths.h"
#include "sim/images/image_truth.h"
#include "sim/noise_free_view.h"
#include "stereo/disparity_file.h"
#include "stereo/rectification.h"
#include "stereo/stereo_truth.h"
#include "tests/support/small_office.h"

namespace vernier::test {

using namespace vernier::sim;
using namespace vernier::sim::internal;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The nominal rig with other lenses, a turned right camera and a longer baseline.
Rig wrong_rig() {
  Rig rig = nominal_rig().rig;
  rig.T_camera_first[1].R = rotation_from_vector({0.004, -0.003, 0.006}) * rig.T_camera_first[1].R;
  rig.T_camera_first[1].t *= 1.03;
  for (Camera& camera : rig.cameras) camera.parameters[0] *= 1.01;
  return rig;
}

struct TrueView {
  Rig truth = nominal_rig().rig;
  ImageScene scene = image_scene(small_office());
  Pose T_left = T_left_world(map_poses(small_office().route, 2)[2], {});
};

TEST(ToldTruth, OfTheTrueRigIsThatOfThePair) {
  const TrueView seen;
  const stereo::RectifiedGeometry geometry = stereo::rectified_geometry(seen.truth);
  const ToldTruth told = told_truth(seen.scene, seen.truth, seen.truth, geometry, seen.T_left, 1);
  const PairTruth pair =
      pair_truth(seen.scene, seen.truth, rectified_view(seen.truth, geometry, seen.T_left), 1);
  const stereo::StereoTruth known = stereo::stereo_truth(pair.left, &pair.right);
  int compared = 0, other_surface = 0, occluded_alike = 0;
  for (std::size_t i = 0; i < pair.left_depth_m.size(); ++i) {
    const float d = known.disparity.values[i], d_told = told.stereo.disparity.values[i];
    ASSERT_EQ(std::isfinite(d), std::isfinite(d_told)) << i;
    if (!std::isfinite(d)) continue;
    ++compared;
    // Single precision of the traced rays takes the other surface at few outlines.
    if (std::abs(d - d_told) > 1e-3F * (1 + d)) {
      ++other_surface;
      continue;
    }
    EXPECT_NEAR(told.depth_m[i], pair.left_depth_m[i], 1e-4 * pair.left_depth_m[i]);
    if (std::isfinite(told.vertical_px[i])) {
      EXPECT_NEAR(told.vertical_px[i], 0, 1e-4);
    }
    occluded_alike += known.occluded[i] == told.stereo.occluded[i];
  }
  EXPECT_GT(compared, 250000);
  EXPECT_LT(other_surface, compared / 2000);
  EXPECT_GT(occluded_alike, 0.995 * compared);
}

TEST(ToldTruth, IsWhereTheTrueRigSeesAPoint) {
  const TrueView seen;
  const Rig wrong = wrong_rig();
  const stereo::RectifiedGeometry geometry = stereo::rectified_geometry(wrong);
  const ToldTruth told = told_truth(seen.scene, seen.truth, wrong, geometry, seen.T_left, 1);
  const stereo::DisparityMap& map = told.stereo.disparity;
  // From the true camera's own pixels, whose depths are exact.
  const Camera& left = seen.truth.cameras[0];
  const std::vector<double> depths = depths_m(seen.scene, left, seen.T_left);
  int compared = 0, off = 0, hidden = 0;
  double largest_row_px = 0;
  for (int y = 2; y < left.size_px[1]; y += 5) {
    for (int x = 2; x < left.size_px[0]; x += 5) {
      const double z = depths[static_cast<std::size_t>(y * left.size_px[0] + x)];
      if (!std::isfinite(z)) continue;
      const Vector3d point = z * unproject(left, Vector2d(x, y));
      const auto at = stereo::rectified_pixel(wrong, geometry, 0, Vector2d(x, y));
      const Vector3d x_right = seen.truth.T_camera_first[1] * point;
      if (!at || x_right.z() < 0.1) continue;
      const auto other =
          stereo::rectified_pixel(wrong, geometry, 1, project(seen.truth.cameras[1], x_right));
      const int u = static_cast<int>(std::lround(at->x()));
      const int v = static_cast<int>(std::lround(at->y()));
      if (!other || u < 1 || v < 1 || u > map.width_px - 2 || v > map.height_px - 2) continue;
      const auto i = static_cast<std::size_t>(v * map.width_px + u);
      if (!std::isfinite(told.vertical_px[i])) continue;
      ++compared;
      hidden += told.stereo.occluded[i];
      // The pixel's middle is at most half a pixel away: a surface's gradient, or an outline.
      off += std::abs(map.values[i] - (at->x() - other->x())) > 0.3 ||
             std::abs(told.vertical_px[i] - (other->y() - at->y())) > 0.05;
      largest_row_px = std::max(largest_row_px, std::abs(double{told.vertical_px[i]}));
    }
  }
  EXPECT_GT(compared, 8000);
  EXPECT_LT(off, compared / 25);
  EXPECT_LT(hidden, compared / 5);
  EXPECT_GT(largest_row_px, 2);  // 6 mrad of roll at the border, 4 of tilt
}

}  // namespace
}  // namespace vernier::test
