// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/rig_estimate.h"
#include "cli/program/cli11_fwd.h"
#include "cli/program/session.h"
#include "cli/simulation/source_options.h"
#include "sim/robot.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::cli {

/// Options of verbs that let a robot drive.
struct RobotArguments {
  std::string world = "workshop", rig = "nominal";
  double height_m = 1.2, pitch_deg = 0;
  SourceOptions sources;
  std::vector<std::string> robot;
  std::uint64_t seed = 1;
};

void add_robot_options(CLI::App& verb, RobotArguments& arguments);

/// The world, the rig and the robot of these options. Furniture has moved if a source says so.
/// Throws Error for what they name wrongly.
class RobotStage {
 public:
  RobotStage(const RobotArguments& arguments, Session& session);
  // The robot refers to the world.
  RobotStage(const RobotStage&) = delete;
  RobotStage& operator=(const RobotStage&) = delete;

  const World& world() const { return world_; }
  const Visibility& visibility() const { return visibility_; }
  const RigEstimate& rig() const { return rig_; }
  /// Without corners.
  const RobotOptions& options() const { return options_; }

 private:
  RobotOptions options_;
  World world_;
  Visibility visibility_;
  RigEstimate rig_;
};

}  // namespace vernier::cli
