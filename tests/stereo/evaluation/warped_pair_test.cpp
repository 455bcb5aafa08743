// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/warped_pair.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/camera.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "calib/statistics/random.h"
#include "stereo/canny_edges.h"
#include "stereo/disparity_file.h"
#include "stereo/edge_matcher.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/rectification.h"
#include "stereo/rectification/vertical_field.h"
#include "stereo/stereo_truth.h"
#include "tests/support/calibrations_covariance.h"
#include "tests/support/error_message.h"
#include "tests/support/leaf_pair.h"
#include "tests/support/scenes.h"

namespace vernier {

using namespace vernier::internal;
using namespace vernier::stereo;
using namespace vernier::stereo::internal;

namespace {

constexpr DisparityRange range{0, 48};

/// A slanted plane of leaves as a rig's rectified pair.
struct Scene {
  test::LeafPlane plane{.disparity_px = 22, .by_x = 0.03, .by_y = -0.02};
  Rig rig = test::stereo_rig();
  RectifiedGeometry geometry =
      rectified_geometry(rig, {.size_px = {plane.width_px, plane.height_px}, .f_px = 270});
  RectifiedPair pair = test::leaf_pair(plane, 911);
  StereoTruth truth;

  Scene() {
    DisparityMap map{plane.width_px, plane.height_px, {}};
    for (int y = 0; y < plane.height_px; ++y) {
      for (int x = 0; x < plane.width_px; ++x) {
        map.values.push_back(static_cast<float>(plane.disparity_at(x, y)));
      }
    }
    truth = stereo_truth(std::move(map));
  }

  Rig drawn(double psi_c, std::uint32_t trial) const {
    RigEstimate estimate;
    estimate.rig = rig;
    estimate.covariance = test::calibrations_covariance(rig);
    return RigSampler(estimate).sample(psi_c, 912, trial);
  }
};

TEST(WarpedPair, TheTrueRigChangesNothing) {
  const Scene scene;
  const WarpedPair same =
      rectified_by(scene.rig, scene.rig, scene.geometry, scene.pair, scene.truth);
  for (std::size_t i = 0; i < same.bias_px.values.size(); ++i) {
    ASSERT_NEAR(same.truth.disparity.values[i], scene.truth.disparity.values[i], 1e-4) << i;
    ASSERT_NEAR(same.vertical_px.values[i], 0, 1e-4);
    ASSERT_NEAR(same.pair.left.values[i], scene.pair.left.values[i], 0.01);
    ASSERT_NEAR(same.pair.right.values[i], scene.pair.right.values[i], 0.01);
  }
}

/// The map's value at a place, linearly: its values change slowly.
double between(const DisparityMap& map, const Eigen::Vector2d& at) {
  const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
  const double s = at.x() - x, t = at.y() - y;
  return (1 - t) * ((1 - s) * map(x, y) + s * map(x + 1, y)) +
         t * ((1 - s) * map(x, y + 1) + s * map(x + 1, y + 1));
}

TEST(WarpedPair, CarriesPointsOfSpaceAsTheCamerasSeeThem) {
  const Scene scene;
  for (std::uint32_t trial = 0; trial < 3; ++trial) {
    const Rig believed = scene.drawn(3, trial);
    const WarpedPair warped =
        rectified_by(believed, scene.rig, scene.geometry, scene.pair, scene.truth);
    RectifiedGeometry drawn = scene.geometry;
    drawn.turn = rectification(believed);
    for (double v = 40; v < 200; v += 31) {
      for (double u = 60; u < 280; u += 43) {
        const double d = scene.plane.disparity_at(u, v), z = scene.geometry.depth_m(d);
        const Eigen::Vector2d from_centre = Eigen::Vector2d(u, v) - scene.geometry.centre_px;
        const Eigen::Vector3d rectified(from_centre.x() * z / scene.geometry.f_px,
                                        from_centre.y() * z / scene.geometry.f_px, z);
        const Eigen::Vector3d point = scene.geometry.turn.R_rectified_left.transpose() * rectified;
        Eigen::Vector2d at[2];
        for (int camera = 0; camera < 2; ++camera) {
          const auto c = static_cast<std::size_t>(camera);
          const auto raw = project(scene.rig.cameras[c], scene.rig.T_camera_first[c] * point);
          at[camera] = rectified_pixel(believed, drawn, camera, raw).value();
        }
        EXPECT_NEAR(between(warped.truth.disparity, at[0]), at[0].x() - at[1].x(), 2e-3);
        EXPECT_NEAR(between(warped.vertical_px, at[0]), at[0].y() - at[1].y(), 2e-3);
        EXPECT_NEAR(between(warped.bias_px, at[0]), at[0].x() - at[1].x() - d, 2e-3);
      }
    }
  }
}

/// Of matches away from the border: root mean square error of those within 1 px, the share of
/// others, and how many.
struct WarpedErrors {
  double rms_px = 0, wrong = 0;
  int matched = 0;
};

WarpedErrors errors(const WarpedPair& warped) {
  const std::vector<EdgePoint> edges = canny_edges(warped.pair.left);
  const MatcherScore score =
      evaluate(edges, edge_matcher().match(warped.pair, edges, range), truth_at(warped, edges),
               warped.pair.left.width_px, {.min_angle_rad = 0.35, .border_px = 40});
  return {score.all.rms_inlier_px, score.all.bad_1, score.all.matched};
}

/// Share of random disparities that count as wrong by more than a pixel.
double errors_of_random(const WarpedPair& warped) {
  const std::vector<EdgePoint> edges = canny_edges(warped.pair.left);
  std::vector<EdgeDisparity> found(edges.size());
  RandomStream draws({.seed = 913});
  for (EdgeDisparity& d : found) {
    d.disparity_px = static_cast<float>(draws.uniform(range.min_px, range.max_px));
  }
  return evaluate(edges, found, truth_at(warped, edges), warped.pair.left.width_px,
                  {.min_angle_rad = 0.35, .border_px = 40})
      .all.bad_1;
}

double largest(const DisparityMap& map) {
  double most = 0;
  for (const float value : map.values) {
    if (!std::isnan(value)) most = std::max(most, std::abs(static_cast<double>(value)));
  }
  return most;
}

TEST(WarpedPair, EdgesAreFoundWhereTheTruthSays) {
  const Scene scene;
  const WarpedErrors exact = errors(with_shifted_rows(scene.pair, scene.truth, 0));
  ASSERT_GT(exact.matched, 2000);
  double moved_px = 0;
  for (std::uint32_t trial = 0; trial < 3; ++trial) {
    const WarpedPair warped =
        rectified_by(scene.drawn(1, trial), scene.rig, scene.geometry, scene.pair, scene.truth);
    moved_px = std::max(moved_px, largest(warped.vertical_px));
    const WarpedErrors found = errors(warped);
    EXPECT_GT(found.matched, 0.9 * exact.matched);
    EXPECT_LT(found.rms_px, exact.rms_px + 0.15);
    EXPECT_LT(found.wrong, exact.wrong + 0.06);
    // What counts as right is not so much that anything would: a random disparity is wrong.
    EXPECT_GT(errors_of_random(warped), 0.8);
  }
  EXPECT_GT(moved_px, 1);  // or the crossings were not tried
}

/// Upright lines that lean: bars as long as the image, so that nothing but the crossing is there to
/// be found.
RectifiedPair leaning_bars(double lean, double disparity_px) {
  RectifiedPair pair;
  for (const bool left : {true, false}) {
    GreyLevels& image = left ? pair.left : pair.right;
    image = {320, 240, {}};
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        const double along = x + (left ? 0 : disparity_px) - lean * y;  // a phase of its own each
        image.values.push_back(static_cast<float>(128 + 50 * std::tanh(4 * std::sin(along / 9)) +
                                                  30 * std::sin(along / 31)));
      }
    }
  }
  return pair;
}

TEST(WarpedPair, LongEdgesAreFoundAtTheirCrossing) {
  for (const double lean : {-1.0, 0.7}) {
    const RectifiedPair pair = leaning_bars(lean, 20);
    const StereoTruth truth = stereo_truth({320, 240, std::vector<float>(320 * 240, 20)});
    const WarpedPair moved = with_shifted_rows(pair, truth, 1.5);
    const std::vector<EdgePoint> edges = canny_edges(moved.pair.left);
    const std::vector<TruthAtEdge> at = truth_at(moved, edges);
    const std::vector<EdgeDisparity> found = edge_matcher().match(moved.pair, edges, {14, 26});
    int matched = 0, near = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const bool inside = std::abs(edges[i].x - 160) < 110 && std::abs(edges[i].y - 120) < 105;
      if (!found[i].matched() || !inside) continue;
      ++matched;
      EXPECT_NEAR(at[i].crossing_px, 1.5 * lean, 0.03);
      near += std::abs(found[i].disparity_px - 20 - 1.5 * lean) < 0.1;
    }
    EXPECT_GT(matched, 100);
    EXPECT_GT(near, 0.95 * matched);
  }
}

TEST(WarpedPair, RepairTakesMovedRowsAway) {
  const Scene scene;
  const WarpedErrors exact = errors(with_shifted_rows(scene.pair, scene.truth, 0));
  WarpedPair moved = with_shifted_rows(scene.pair, scene.truth, 2);
  EXPECT_EQ(largest(moved.vertical_px), 2);
  const VerticalField field = vertical_field(moved.pair, range);
  ASSERT_TRUE(field.significant);
  repair(moved, field);
  EXPECT_LT(largest(moved.vertical_px), 0.1);
  const WarpedErrors repaired = errors(moved);
  EXPECT_LT(repaired.rms_px, exact.rms_px + 0.03);
  EXPECT_LT(repaired.wrong, exact.wrong + 0.01);
}

TEST(WarpedPair, IsTheSameForAnyNumberOfThreads) {
  const Scene scene;
  const Rig believed = scene.drawn(1, 0);
  const WarpedPair one = rectified_by(believed, scene.rig, scene.geometry, scene.pair, scene.truth);
  const WarpedPair four =
      rectified_by(believed, scene.rig, scene.geometry, scene.pair, scene.truth, 4);
  EXPECT_EQ(one.pair.right.values, four.pair.right.values);
  EXPECT_EQ(one.truth.occluded, four.truth.occluded);
  for (std::size_t i = 0; i < one.bias_px.values.size(); ++i) {
    const float a = one.bias_px.values[i], b = four.bias_px.values[i];
    ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
  }
}

TEST(WarpedPair, RefusesAnotherSize) {
  Scene scene;
  scene.pair.right = GreyLevels{10, 10, std::vector<float>(100)};
  EXPECT_NE(test::error_message([&] {
              rectified_by(scene.rig, scene.rig, scene.geometry, scene.pair, scene.truth);
            }).find("the right one 10x10"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier
