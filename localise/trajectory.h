// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/odometry.h"
#include "localise/place.h"

namespace vernier::localise {

/// Where a camera was at a moment.
struct TimedPose {
  double time_s = 0;
  Pose T_world_camera;
};

/// Reads a trajectory: lines `time_s x y z qx qy qz qw` (TUM), or rows of 3 x 4 matrices (KITTI),
/// whose times are 0, 1, 2 …; lines of KITTI's may be joined. Comments begin with #. Throws Error
/// with file and line for a line of other fields, a rotation that is none, and times that do not
/// ascend.
std::vector<TimedPose> read_trajectory(const std::filesystem::path& file);

/// The text of a TUM file, as evo reads it.
std::string tum_text(std::span<const TimedPose> trajectory);

/// A trajectory by odometry, in the frame of its first pose.
struct OdometryPath {
  std::vector<Pose> T_first_camera;              ///< one per moment
  std::vector<std::optional<MotionStep>> steps;  ///< between them; none where it was not found
  /// Of the last pose in the tangent of retract() (rad, m), from the noise of the corners, which
  /// successive steps share; NaN if a step was not found.
  Eigen::Matrix<double, 6, 6> end_covariance;
  /// Derivative of the last pose by the rig's parameters: 6 x parameters; NaN if a step was not
  /// found.
  Eigen::Matrix<double, 6, Eigen::Dynamic> end_by_rig;
};

/// Links the corners of successive moments and chains their steps. Where a step is not found, the
/// motion of the step before is repeated.
OdometryPath odometry_path(const Rig& rig,
                           std::span<const std::vector<StereoCorner>> moments,
                           const CornerLinkOptions& linking = {},
                           const StepOptions& options = {});

/// How far an estimated trajectory is from the true one.
struct TrajectoryDrift {
  double length_m = 0;     ///< of the true path
  double end_error_m = 0;  ///< after both begin with the same pose
  double end_error_rad = 0;
  int segments = 0;               ///< that the means below are over
  double translation_share = 0;   ///< mean error over a segment, per length
  double rotation_rad_per_m = 0;  ///< mean error over a segment, per length
};

/// Mean relative errors over all segments of `segment_m` along the true path, as KITTI's odometry
/// benchmark has them (Geiger, Lenz and Urtasun, CVPR 2012). Throws Error unless both trajectories
/// have as many poses, two or more.
TrajectoryDrift drift_of(std::span<const Pose> estimate,
                         std::span<const Pose> truth,
                         double segment_m);

/// Squared error of a step in units of its covariance (NEES): six on average if the covariance is
/// true. `calibration` is the covariance of the rig's parameters, added by by_rig; empty: none.
double step_nees(const MotionStep& step,
                 const Pose& true_T_from_to,
                 const Eigen::MatrixXd& calibration = {});

}  // namespace vernier::localise
