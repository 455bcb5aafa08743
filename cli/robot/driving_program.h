// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calib/base/answering_program.h"
#include "calib/rig.h"
#include "cli/program/session.h"
#include "sim/differential_drive.h"
#include "sim/robot.h"

namespace vernier::cli {

/// What a robot is told of an observation, with nothing of the truth: a line of JSON for a program,
/// and of the output.
Json observation_json(const RobotObservation& seen);

/// A program that drives: it is sent observations and answers with commands.
class DrivingProgram {
 public:
  /// Throws Error if it cannot be started. It is told the rig it may believe, its mount and wheels.
  DrivingProgram(const std::string& command,
                 double time_limit_s,
                 const Rig& told,
                 const RobotOptions& robot);

  /// The command for an observation; nothing if the program is done, or failed.
  std::optional<DriveCommand> command(const RobotObservation& seen);

  /// Why it failed, as a predicate of the program; empty if it did not.
  const std::string& failure() const { return failure_; }

 private:
  DifferentialDrive drive_;
  vernier::internal::AnsweringProgram program_;
  std::string failure_;
};

}  // namespace vernier::cli
