// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/localisation/odometry_drives.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "cli/program/camera_images.h"
#include "cli/program/rig_input.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/source_options.h"
#include "localise/pair_corners.h"
#include "localise/place.h"
#include "localise/views/camera_poses.h"
#include "sim/corner_drive.h"
#include "sim/experiment.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "sim/world.h"
#include "sim/world_file.h"
#include "stereo/corners/match_images.h"
#include "stereo/grey_levels.h"

namespace vernier::cli {
namespace {

/// Where the left camera was at each pair. Throws Error if the poses are those of what carries the
/// camera and the rig does not say where on it the camera is.
std::vector<Pose> true_poses(const std::string& truth,
                             const std::optional<Pose>& T_body_left,
                             const std::vector<ImageFiles>& files) {
  const CameraPoses poses = read_camera_poses(truth);
  if (poses.of_body && !T_body_left) {
    throw Error(truth, "holds poses of the body, and the rig does not place its cameras on it",
                "give the ASL folder or sensor.yaml files as --rig");
  }
  std::vector<Pose> T_world_left = poses_of_images(poses, left_images(files), truth);
  if (!poses.of_body) return T_world_left;
  for (Pose& T : T_world_left) T = T * *T_body_left;
  return T_world_left;
}

Eigen::MatrixXd covariance_of(const RigEstimate& rig) {
  return rig.covariance ? rig.covariance->matrix : Eigen::MatrixXd();
}

double length_m(const RouteLeg& leg) { return route_length_m({leg}); }

/// The leg of this number, from 1; 0: the longest.
const RouteLeg& chosen_leg(const World& world, const OdometryOptions& options) {
  if (world.route.empty()) {
    throw Error(options.world, "the world has no route to drive along", "add [[route]] to it");
  }
  const auto legs = static_cast<int>(world.route.size());
  if (options.leg > legs) {
    throw Error("--leg", "the route has " + std::to_string(legs) + " legs", "give one of them");
  }
  if (options.leg > 0) return world.route[static_cast<std::size_t>(options.leg - 1)];
  const RouteLeg* longest = &world.route.front();
  for (const RouteLeg& leg : world.route) {
    if (length_m(leg) > length_m(*longest)) longest = &leg;
  }
  return *longest;
}

}  // namespace

OdometryDrive drive_of_images(const OdometryOptions& options, Session& session) {
  const std::vector<ImageFiles> files = paired_images(options.left, options.right);
  if (files.size() < 2) {
    throw Error("--left", "one pair of images has no motion", "give two pairs or more");
  }
  const ReadRig read = read_stereo_rig(options.rig, session,
                                       {files.front().left.string(), files.front().right.string()});
  const RigEstimate& rig = read.estimate;
  OdometryDrive drive{rig.rig, covariance_of(rig), {}, {}};
  if (!options.truth.empty()) {
    drive.T_world_left = true_poses(options.truth, read.T_body_first, files);
  }
  PairCornersOptions how;
  how.corners = options.corners;
  Progress progress(session, "corners of image pairs");
  for (const ImageFiles& pair : files) {
    const stereo::RectifiedPair images =
        read_camera_images(rig.rig, options.rig, pair.left.string(), pair.right.string(), session);
    drive.moments.push_back(with_errors_of(options.rig, [&] {
      return corners_of_pair(rig.rig, drive.calibration, images.left, images.right, how);
    }));
    progress.update(static_cast<int>(drive.moments.size()), static_cast<int>(files.size()));
  }
  return drive;
}

void for_each_simulated_drive(const OdometryOptions& options,
                              Session& session,
                              const std::function<void(const OdometryDrive&)>& use) {
  constexpr double degree = std::numbers::pi / 180;
  const RigEstimate rig =
      read_stereo_rig(options.rig.empty() ? "nominal" : options.rig, session).estimate;
  ExperimentSettings settings;
  settings.sources = sources_of(options.sources);
  settings.mount = {options.height_m, options.pitch_deg * degree};
  settings.sources.moved = 0;  // there is no map
  settings.seed = options.seed;
  if (settings.sources.calibration > 0) required_covariance(rig, options.rig);
  const Eigen::MatrixXd calibration =
      settings.sources.calibration * settings.sources.calibration * covariance_of(rig);
  const World world = build_world(read_world(find_world(options.world)));
  if (world.corners.empty()) {
    throw Error(options.world, "has no corners, by which odometry finds the steps",
                "add corners to its templates or loose features (docs/file-formats.md)");
  }
  const std::vector<Pose2D> poses =
      drive_poses(chosen_leg(world, options), options.step_m, options.turn_deg * degree);
  const Visibility visibility(world);
  const LocalisationExperiment robot(visibility, rig, nullptr, settings);
  std::optional<Progress> progress;
  if (options.drives > 1) progress.emplace(session, "drives");
  for (int i = 0; i < options.drives; ++i) {
    const auto trial = static_cast<std::uint32_t>(i);
    CornerDrive seen = drive_past_corners(visibility, rig.rig, settings.sources, settings.mount,
                                          poses, options.seed, trial);
    use({robot.estimator_rig(trial), calibration, std::move(seen.moments),
         std::move(seen.T_world_left)});
    if (progress) progress->update(i + 1, options.drives);
  }
}

}  // namespace vernier::cli
