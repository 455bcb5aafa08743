// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/lens_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/calibration/result_checks.h"
#include "calib/camera.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/random.h"
#include "tests/support/rig_distance.h"

namespace vernier {

using namespace vernier::internal;

namespace {

constexpr double degree = std::numbers::pi / 180;

/// Two fisheyes side by side whose images show more than a half-space.
Rig wide_rig() {
  Camera camera;
  camera.name = "left";
  camera.size_px = {1280, 960};
  camera.model = Fisheye4{};
  camera.parameters.resize(8);
  camera.parameters << 300, 1, 641, 478, 0.012, -0.004, 0.002, -0.0008;
  Camera right = camera;
  right.name = "right";
  return {{camera, right}, {Pose{}, Pose{rotation_from_vector({0.01, 0.1, 0}), {-0.1, 0, 0}}}};
}

/// The projection of Kannala and Brandt (IEEE PAMI 28, 2006), which has no limit at 90 degrees.
Eigen::Vector2d seen_by(const Camera& camera, const Eigen::Vector3d& x) {
  const double r = x.head<2>().norm(), t = std::atan2(r, x.z()), t2 = t * t;
  const auto k = camera.parameters.tail<4>();
  const double along = t * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  const Eigen::Vector2d d = x.head<2>() * (r > 0 ? along / r : 1);
  return {camera.f_px() * camera.ax() * d[0] + camera.ox_px(),
          camera.f_px() * d[1] + camera.oy_px()};
}

/// Views of a board close before the cameras, all corners up to an angle from the axis, with noise
/// of 0.2 px; and how many of them lie beyond 90 degrees.
BoardObservations wide_views(const Rig& rig, double most_deg, std::uint64_t seed, int& beyond) {
  constexpr int columns = 12, rows = 9, frames = 30;
  constexpr double square_m = 0.06, sigma_px = 0.2;
  BoardObservations all{{rig.cameras[0].size_px, rig.cameras[1].size_px}, {}, {}};
  for (int i = 0; i < columns * rows; ++i) {
    all.target_m.emplace_back(square_m * (i % columns), square_m * (i / columns), 0);
  }
  const Eigen::Vector3d middle(0.5 * square_m * (columns - 1), 0.5 * square_m * (rows - 1), 0);
  beyond = 0;
  RandomStream d({.seed = seed});
  for (int frame = 0; frame < frames; ++frame) {
    const double from_axis = 60 * degree * std::sqrt(d.uniform()), around = d.uniform(0, 6.28);
    const double distance_m = d.uniform(0.35, 0.8);
    const Eigen::Vector3d at =
        distance_m * Eigen::Vector3d(std::sin(from_axis) * std::cos(around),
                                     std::sin(from_axis) * std::sin(around), std::cos(from_axis));
    // It faces the camera, but for a tilt.
    const Eigen::Matrix3d R =
        rotation_from_vector(from_axis * Eigen::Vector3d(-std::sin(around), std::cos(around), 0)) *
        rotation_from_vector({d.uniform(-0.5, 0.5), d.uniform(-0.5, 0.5), d.uniform(-3, 3)});
    const Pose T_first_board{R, at - R * middle};
    for (int c = 0; c < 2; ++c) {
      BoardView view{frame, c, "", {}, {}};
      for (int i = 0; i < columns * rows; ++i) {
        const Eigen::Vector3d x = rig.T_camera_first[c] * (T_first_board * all.target_m[i]);
        const Eigen::Vector2d pixel = seen_by(rig.cameras[c], x);
        const double angle = std::atan2(x.head<2>().norm(), x.z());
        const Eigen::Vector2d noise(d.normal(), d.normal());
        if (angle > most_deg * degree || !in_image(rig.cameras[c], pixel)) continue;
        beyond += angle > 90 * degree;
        view.ids.push_back(i);
        view.pixels_px.push_back(pixel + sigma_px * noise);
      }
      if (determines_pose(all.target_m, view.ids)) all.views.push_back(view);
    }
  }
  return all;
}

std::size_t corners_of(const BoardObservations& observations) {
  std::size_t corners = 0;
  for (const BoardView& view : observations.views) corners += view.ids.size();
  return corners;
}

// One corner in a hundred beyond 90 degrees spoiled every view it was in. Worst of 22 parameters
// beyond 5 standard deviations: 1e-5.
TEST(LensField, CornersBeyondItAreLeftOutAndTheRestDecides) {
  const Rig rig = wide_rig();
  for (const double most_deg : {91.0, 93.0, 98.0}) {
    int beyond = 0;
    const BoardObservations seen = wide_views(rig, most_deg, 7, beyond);
    ASSERT_GT(beyond, 5);
    const RigEstimate estimate = calibrate(seen, {.model = Fisheye4{}});
    const CalibrationSummary& summary = *estimate.calibration;
    EXPECT_TRUE(summary.trust_warnings.empty()) << summary.trust_warnings[0];
    EXPECT_TRUE(summary.outliers.empty()) << summary.outliers.size();
    EXPECT_NEAR(summary.pixel_sigma_px, 0.2, 0.01);
    EXPECT_LT(test::worst_sigmas(estimate.rig, rig, estimate.covariance->matrix), 5);
    const std::size_t kept = corners_of(estimate.evidence->observations);
    EXPECT_LE(kept, corners_of(seen) - static_cast<std::size_t>(beyond));
    EXPECT_GE(kept, corners_of(seen) - static_cast<std::size_t>(2 * beyond));
    ASSERT_GE(summary.warnings.size(), 2u);
    EXPECT_NE(summary.warnings[0].find("lie 90 degrees from its axis or beyond, where fisheye4"),
              std::string::npos)
        << summary.warnings[0];
  }
}

TEST(LensField, TakesNothingFromWhatIsWithin) {
  const Rig rig = wide_rig();
  int beyond = 0;
  BoardObservations seen = wide_views(rig, 89.3, 8, beyond);
  const std::size_t before = corners_of(seen);
  BoardState state;
  std::vector<std::string> warnings;
  const RigEstimate estimate = calibrate(seen, {.model = Fisheye4{}});
  EXPECT_EQ(corners_of(estimate.evidence->observations), before);
  EXPECT_TRUE(estimate.calibration->outliers.empty());
  EXPECT_LT(test::worst_sigmas(estimate.rig, rig, estimate.covariance->matrix), 5);
}

TEST(LensField, IsToldApartFromAFold) {
  Rig rig = wide_rig();
  EXPECT_TRUE(is_beyond(rig.cameras[0], {1200, 478}, fisheye_field_rad));
  EXPECT_FALSE(is_beyond(rig.cameras[0], {1000, 478}, fisheye_field_rad));
  for (const std::string& warning : inversion_warnings(rig)) {
    EXPECT_NE(warning.find("sees 90 degrees from its axis and beyond in 4"), std::string::npos)
        << warning;
  }
  rig.cameras[0].parameters.tail<4>() << -0.3, 0, 0, 0;  // rises up to 60 degrees
  EXPECT_FALSE(is_beyond(rig.cameras[0], {1200, 478}, fisheye_field_rad));
  EXPECT_NE(inversion_warnings(rig).at(0).find("cannot be inverted in"), std::string::npos);
  rig.cameras[0].model = OpenCv4{};
  EXPECT_FALSE(is_beyond(rig.cameras[0], {1200, 478}, fisheye_field_rad));
}

}  // namespace
}  // namespace vernier
