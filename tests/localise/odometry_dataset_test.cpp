// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// Odometry and localisation on real images. The corner errors of PairCornersOptions were chosen on
// these frames of `drive`, so that their chi2 and the agreement of halves are not held out; drift
// was not tuned.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/localiser.h"
#include "localise/odometry.h"
#include "localise/pair_corners.h"
#include "localise/place.h"
#include "localise/topological_map.h"
#include "localise/trajectory.h"
#include "stereo/grey_levels.h"
#include "tests/support/data_folder.h"

namespace vernier::localise {
namespace {

// KITTI's rectified cameras, as calib.txt beside the images has them.
constexpr double f_px = 707.0912, u0_px = 601.8873, v0_px = 183.1104;
constexpr double baseline_m = 379.8145 / f_px;

Camera camera_of_drive(const char* name) {
  Camera camera;
  camera.name = name;
  camera.model = Pinhole{};
  camera.size_px = {1226, 370};
  camera.parameters.resize(core_parameter_count);
  camera.parameters << f_px, 1, u0_px, v0_px;
  return camera;
}

Rig rig_of_drive() {
  Rig rig;
  rig.cameras = {camera_of_drive("left"), camera_of_drive("right")};
  rig.T_camera_first = {Pose{}, {Eigen::Matrix3d::Identity(), {-baseline_m, 0, 0}}};
  return rig;
}

struct Drive {
  Rig rig;
  std::vector<Pose> T_first_left;
  std::vector<std::vector<StereoCorner>> moments;
};

Drive read_drive(const std::filesystem::path& folder) {
  Drive drive{rig_of_drive(), {}, {}};
  PairCornersOptions how;
  how.nearest_m = 2;
  for (const TimedPose& pose : read_trajectory(folder / "poses.txt")) {
    const std::string name = fmt::format("{:06}.png", drive.moments.size());
    drive.T_first_left.push_back(pose.T_world_camera);
    drive.moments.push_back(
        corners_of_pair(drive.rig, {}, stereo::read_grey_levels(folder / "image_l" / name),
                        stereo::read_grey_levels(folder / "image_r" / name), how));
  }
  return drive;
}

// Noise draws none here: the figures are those of one computation.
TEST(OdometryOfRealImages, DriftsByAPercentAndKnowsItsNoise) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA is not set";
  const Drive drive = read_drive(*data / "sequences" / "drive");
  const OdometryPath path = odometry_path(drive.rig, drive.moments);
  double chi2 = 0, dof = 0;
  for (const auto& step : path.steps) {
    ASSERT_TRUE(step);
    chi2 += step->chi2;
    dof += step->dof;
  }
  EXPECT_GT(chi2 / dof, 0.8);
  EXPECT_LT(chi2 / dof, 1.25);
  const TrajectoryDrift drift = drift_of(path.T_first_camera, drive.T_first_left, 10);
  EXPECT_LT(drift.translation_share, 0.013);
  EXPECT_LT(drift.rotation_rad_per_m, 3e-4);

  // Steps from the even and the odd links differ by what both state: chi2 with six degrees of
  // freedom each. The bounds allow the covariance to be wrong by a factor of 1.5.
  std::vector<double> nees;
  for (std::size_t i = 0; i + 1 < drive.moments.size(); ++i) {
    std::vector<CornerLink> halves[2];
    for (const CornerLink& link : path.steps[i]->inliers) {
      halves[link.from % 2].push_back(link);
    }
    const auto even = estimate_step(drive.rig, drive.moments[i], drive.moments[i + 1], halves[0]);
    auto odd = estimate_step(drive.rig, drive.moments[i], drive.moments[i + 1], halves[1]);
    ASSERT_TRUE(even && odd);
    odd->covariance += even->covariance;
    nees.push_back(step_nees(*odd, even->T_from_to));
  }
  std::nth_element(nees.begin(), nees.begin() + 25, nees.end());
  EXPECT_GT(nees[25], 5.35 / 1.5);
  EXPECT_LT(nees[25], 5.35 * 1.5);
}

/// The robot's pose of a left camera whose first pose is level: z forward, x right.
Pose2D on_floor(const Pose& T_first_left) {
  return {T_first_left.t.z(), -T_first_left.t.x(),
          -std::atan2(T_first_left.R(0, 2), T_first_left.R(2, 2))};
}

// The odd frames are found on a map of the even ones. The road is not level, and the car pitches:
// what the localiser takes for known is so only nearly.
TEST(CornersOfRealImages, FindFramesBetweenThoseOfTheMap) {
  const auto data = test::data_folder();
  if (!data) GTEST_SKIP() << "VERNIER_DATA is not set";
  const Drive drive = read_drive(*data / "sequences" / "drive");
  TopologicalMap map;
  std::vector<MapNode> queries;
  for (std::size_t i = 0; i < drive.moments.size(); ++i) {
    PlaceView view;
    view.rig = std::make_shared<const Rig>(drive.rig);
    view.mount.height_m = 1.65;
    view.corners = drive.moments[i];
    (i % 2 == 0 ? map.nodes : queries).push_back({on_floor(drive.T_first_left[i]), view});
  }
  const auto localiser = make_localiser("corners", map);
  int answered = 0;
  std::vector<double> errors_m;
  for (const MapNode& query : queries) {
    const LocalisationAnswer answer = localiser->localise(query.view);
    answered += answer.status == LocalisationStatus::answered;
    errors_m.push_back(answer.node < 0 ? 1e9 : distance_m(answer.pose, query.pose));
  }
  std::sort(errors_m.begin(), errors_m.end());
  const double median_m = errors_m[errors_m.size() / 2];
  RecordProperty("queries", std::to_string(queries.size()));
  RecordProperty("answered", answered);
  RecordProperty("median_error_m", fmt::format("{:.3f}", median_m));
  RecordProperty("largest_error_m", fmt::format("{:.3f}", errors_m.back()));
  EXPECT_GE(answered, static_cast<int>(queries.size()) - 2);
  EXPECT_LT(median_m, 0.15);
}

}  // namespace
}  // namespace vernier::localise
