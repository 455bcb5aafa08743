// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"

namespace vernier::sim {

struct RobotOptions {
  DifferentialDrive drive;
  OdometryError odometry;
  SourceSettings sources;  ///< of what it sees, and of the rig it is told; `moved` must be 0
  localise::CameraMount mount;
  bool with_corners = false;  ///< they take about as long as the edges
};

/// What a robot knows after a step: what its wheels did, and what its rig sees.
struct RobotObservation {
  std::uint32_t frame = 0;    ///< steps since reset()
  double time_s = 0;          ///< since reset()
  localise::Pose2D odometry;  ///< where it believes to be, in the frame of its start
  double left_wheel_rad = 0, right_wheel_rad = 0;  ///< turned in this step, as an encoder says
  bool contact = false;  ///< it touched something: wheels stopped, the rest of the step is left out
  /// Ends in the images. Its true edges and identities are for scoring only, as in studies. A
  /// source of one's own that failed is told in `failure`.
  StereoObservation view;
};

/// A robot that drives in a simulated building on command, with a stereo rig on its body.
///
///     Observation = reset(seed, trial, start), then step(command) as often as wanted
///
/// The frame is the index of the step, and the key of all draws of what is seen and of the noise of
/// the wheels: the same (seed, trial, start) and commands give the same observations to the bit,
/// whatever else runs. Furniture that moved is a matter of the world (with_moved_furniture). A copy
/// drives on from where the robot is, and shares what does not change: make one, and copy it for
/// each trial. Not for several threads at once; copies may be.
class Robot {
 public:
  /// Keeps a reference to `visibility`. Throws Error for options out of range, moved furniture, and
  /// a rig without two cameras, or without covariance if sources.calibration > 0.
  Robot(const Visibility& visibility, const RigEstimate& rig, const RobotOptions& options = {});

  /// Puts it at a pose, at rest: frame 0. Draws the rig it is told, its mount and wheels: counter
  /// (trial). Throws Error if it cannot stand there.
  RobotObservation reset(std::uint64_t seed, std::uint32_t trial, const localise::Pose2D& start);

  /// Drives. A command that check() refuses throws Error and leaves the robot as it was.
  RobotObservation step(const DriveCommand& command);

  /// The rig that the estimator is told, with the error psi_c of this trial.
  const Rig& told_rig() const { return told_; }
  const RobotOptions& options() const;
  /// Where it truly is; for scoring only.
  const localise::Pose2D& true_pose() const { return pose_; }
  /// Whether nothing is within its body at a place, nor within `room_m` around it; whether it can
  /// get there is another question.
  bool fits(const localise::Pose2D& at, double room_m = 0) const;
  /// What it would see from a pose, in this trial and the frame of this number, without being
  /// there; for views that were recorded before, as of a goal.
  StereoObservation view_from(const localise::Pose2D& pose, std::uint32_t frame) const;

 private:
  struct Setup;
  RobotObservation observe() const;

  std::shared_ptr<const Setup> setup_;
  std::uint64_t seed_ = 1;
  std::uint32_t trial_ = 0, frame_ = 0;
  double time_s_ = 0;
  Rig told_;
  std::shared_ptr<const OdometryDraw> odometry_draw_;
  localise::Pose2D pose_, odometry_;
  WheelSpeeds wheels_;
  double left_m_ = 0, right_m_ = 0;  // of the rims, in the last step
  bool contact_ = false;
};

}  // namespace vernier::sim
