// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig_estimate.h"
#include "localise/place.h"
#include "sim/robot.h"
#include "sim/visibility.h"

namespace vernier::sim {

/// Where the desired view of the door frame comes from.
enum class ServoGoal {
  taught,    ///< the robot stood there and saw it, in the same light and with the same rig
  recorded,  ///< the same on another day, in other light: draws of its own, as maps have
  model,     ///< computed from the building's model for the rig that the robot is told
};
std::string_view name(ServoGoal goal);
/// Throws Error for a name other than taught, recorded, model.
ServoGoal servo_goal(std::string_view name);

/// The law, and when it ends.
struct ServoLaw {
  double frame_s = 0.3;         ///< between views
  double approach_per_s = 0.6;  ///< gamma: speed over the distance to the goal
  double bearing_per_s = 1.2;   ///< k: turning over the bearing of the goal
  double curve = 2;             ///< h: how much the way bends to arrive along the goal's axis
  double settle_per_s = 1;      ///< of what is left at the goal, along the axis and in heading
  double fastest_mps = 0.4, fastest_radps = 0.5;
  double fix_share = 0.4;  ///< of a new view in the goal's place, the rest by the motion since
  double across_tolerance_m = 0.02;  ///< at the goal; beyond it the robot retreats and comes again
  double retreat_m = 0.5;
  double time_limit_s = 60;
};

struct ServoOptions {
  ServoGoal goal = ServoGoal::taught;
  std::string door = "door_frame";  ///< template of the objects to stand in front of
  double distance_m = 1.8;          ///< of the goal from the middle of the door, on its y side
  /// The start is drawn uniformly: so far behind the goal, to its sides, and turned from it.
  double nearest_back_m = 0.6, farthest_back_m = 1.4, aside_m = 0.4, turned_rad = 0.17;
  ServoLaw law;
};

enum class ServoStatus {
  converged,  ///< by what the images say: the robot cannot know better
  timed_out,
  lost,    ///< the door was not found, or no longer
  failed,  ///< a source of one's own failed
};
std::string_view name(ServoStatus status);

struct ServoTrial {
  std::uint32_t trial = 0;
  int door = 0;  ///< index of the object
  localise::Pose2D goal, start, end;
  ServoStatus status = ServoStatus::lost;
  double position_error_m = 0;       ///< distance of the end from the goal
  double along_m = 0, across_m = 0;  ///< of the end in the goal's frame: forward, to the left
  double heading_error_rad = 0;
  double image_error_px = 0;  ///< of the last view: root mean square of the lines' distances
  int frames = 0, lines = 0;  ///< steps; lines of the desired view
  int contacts = 0, retreats = 0;
  double time_s = 0;
  std::vector<localise::Pose2D> way;  ///< true poses, one a frame
  std::string failure;
};

/// Visual servoing: the robot drives to stand in front of a door by the lines of its frame.
///
/// The image error of these lines, in both images, is mapped to the floor by the interaction matrix
/// of lines (Espiau, Chaumette and Rives 1992; image-based visual servoing: Chaumette and
/// Hutchinson, "Visual servo control, part I", IEEE Robotics and Automation Magazine 13(4), 2006).
/// A differential drive has two freedoms for three errors, and no smooth static law of the pose
/// brings it to rest (Brockett 1983), so the law is that of Aicardi, Casalino, Bicchi and
/// Balestrino, "Closed loop steering of unicycle-like vehicles via Lyapunov techniques", IEEE
/// Robotics and Automation Magazine 2(1), 1995, in polar coordinates (e, alpha, theta) of the goal:
///
///     v = gamma e cos(alpha),   w = k alpha + gamma sin(alpha) cos(alpha) / alpha (alpha + h
///     theta)
///
/// At the goal the robot settles heading and distance, and comes again if it stands aside
/// (docs/robot.md). All error sources act in every frame. Immutable.
class ServoExperiment {
 public:
  /// Keeps a reference to `visibility`. Throws Error for options out of range, and a world without
  /// such a door that has room in front of it.
  ServoExperiment(const Visibility& visibility,
                  const RigEstimate& rig,
                  const RobotOptions& robot,
                  const ServoOptions& options);

  /// Depends on (seed, trial) only; door and start are the same whatever the sources are. Throws
  /// Error if no start is free in 1000 draws.
  ServoTrial run(std::uint64_t seed, std::uint32_t trial) const;

  /// Poses to stand at, one for each door that can be used.
  const std::vector<localise::Pose2D>& goals() const { return goals_; }

 private:
  /// Whether a robot can drive straight from a start behind the goal to it.
  bool is_way(const localise::Pose2D& goal, double back_m, double aside_m) const;
  bool has_starts(const localise::Pose2D& goal) const;
  localise::Pose2D draw_start(const localise::Pose2D& goal,
                              std::uint64_t seed,
                              std::uint32_t trial) const;

  const Visibility& visibility_;
  RigEstimate rig_;
  Robot robot_;
  ServoOptions options_;
  std::vector<int> doors_;  // objects
  std::vector<localise::Pose2D> goals_;
};

}  // namespace vernier::sim
