// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/servo/goal_alignment.h"
#include "sim/servo/stereo_line.h"
#include "sim/visual_servo.h"

namespace vernier::sim::internal {

/// Aicardi's law for a goal in the robot's frame (sim/visual_servo.h), slowed down as a whole where
/// a speed would be beyond its limit. The bearing is that of a goal in front.
DriveCommand approach(const localise::Pose2D& goal, const ServoLaw& law);

/// The command without turning that would take the door out of the image, as far as the goal says
/// where it is: none with an outermost line beyond 0.8 of half the image, back to it beyond 0.9.
/// `half_width` is that of the left image, normalised. A door that is too near for both of its
/// sides is let go.
DriveCommand kept_in_view(DriveCommand command,
                          const DesiredView& desired,
                          const localise::Pose2D& goal,
                          double half_width);

/// Heading and distance along the goal's axis, what a robot can correct on the spot.
DriveCommand settle(const localise::Pose2D& goal, const ServoLaw& law);

/// The desired lines in the views, from one to the next. A line that was seen is expected where it
/// was, moved by odometry; one that was not, where the goal says.
class LineTracker {
 public:
  /// Keeps a reference to `desired`.
  LineTracker(const DesiredView& desired, const localise::Pose2D& goal);

  /// Matches a view taken after the robot has moved by `step` (by odometry), with `goal` as it is
  /// expected now, and says what the image error tells of the goal. Nothing if too few lines agree.
  std::optional<GoalFix> track(std::span<const SeenLine> seen,
                               const localise::Pose2D& step,
                               const localise::Pose2D& goal);

 private:
  const DesiredView& desired_;
  std::vector<std::optional<SpaceLine>> last_;  // in the camera's frame of the last view
};

/// The stages of a drive: approach, settle, and a retreat if it ends beside the goal or touches
/// something.
class ServoControl {
 public:
  ServoControl(const localise::Pose2D& goal, const ServoLaw& law) : law_(law), goal_(goal) {}

  /// Where the goal should be after the robot has moved by `step`.
  void move(const localise::Pose2D& step);
  /// Takes in where a view says it is.
  void correct(const localise::Pose2D& seen);
  /// What to do next; nothing if it has arrived, by a view in which the door was `seen`.
  std::optional<DriveCommand> next(bool seen, bool touched);

  const localise::Pose2D& goal() const { return goal_; }
  int retreats() const { return retreats_; }

 private:
  enum class Stage { approach, settle, retreat };

  void retreat();

  ServoLaw law_;
  localise::Pose2D goal_;
  Stage stage_ = Stage::approach;
  int settled_ = 0, retreats_ = 0;
};

}  // namespace vernier::sim::internal
