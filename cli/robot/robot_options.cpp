// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/robot/robot_options.h"

#include <CLI/CLI.hpp>
#include <cstddef>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "calib/error.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/simulation/source_options.h"
#include "sim/differential_drive.h"
#include "sim/moved_furniture.h"
#include "sim/robot.h"
#include "sim/sources.h"
#include "sim/world.h"
#include "sim/world_file.h"

namespace vernier::cli {
namespace {

const DriveParameter& parameter_named(const std::string& word) {
  const std::size_t equals = word.find('=');
  std::string names = "exact";
  for (const DriveParameter& p : drive_parameters()) {
    if (equals != std::string::npos && p.name == word.substr(0, equals)) return p;
    names += ", " + std::string(p.name) + "=…";
  }
  throw Error("--robot " + word, "unknown setting of the robot", "supported: " + names);
}

/// Applies settings of --robot; "exact", given first, leaves out all errors of odometry.
void apply(const std::vector<std::string>& words, RobotOptions& options) {
  std::set<std::string_view> given;
  for (const std::string& word : words) {
    if (word == "exact") {
      if (!given.empty()) {
        throw Error("--robot exact", "would override the settings given before it",
                    "give it first");
      }
      options.odometry = no_odometry_error();
      continue;
    }
    const DriveParameter& p = parameter_named(word);
    if (!given.insert(p.name).second) {
      throw Error("--robot " + word, "this setting is given twice", "give one value");
    }
    const double value = parse_numbers(word.substr(word.find('=') + 1), 1, "--robot " + word)[0];
    if (p.drive) options.drive.*p.drive = value;
    if (p.error) options.odometry.*p.error = value;
  }
  check(options.drive, "--robot");
  check(options.odometry, "--robot");
}

RobotOptions options_of(const RobotArguments& arguments) {
  RobotOptions options;
  options.mount = {arguments.height_m, arguments.pitch_deg * std::numbers::pi / 180};
  options.sources = sources_of(arguments.sources);
  apply(arguments.robot, options);
  return options;
}

World world_of(const RobotArguments& arguments, RobotOptions& options) {
  World world = build_world(read_world(find_world(arguments.world)));
  const double moved = std::exchange(options.sources.moved, 0);
  return moved > 0 ? with_moved_furniture(world, moved, arguments.seed) : world;
}

RigEstimate rig_for(const RobotArguments& arguments,
                    const RobotOptions& options,
                    Session& session) {
  const RigFile file = read_rig(find_rig(arguments.rig));
  for (const std::string& warning : file.warnings) session.warn(warning);
  if (options.sources.calibration > 0) required_covariance(file.estimate, arguments.rig);
  return file.estimate;
}

}  // namespace

RobotStage::RobotStage(const RobotArguments& arguments, Session& session)
    : options_(options_of(arguments)),
      world_(world_of(arguments, options_)),
      visibility_(world_),
      rig_(rig_for(arguments, options_, session)) {}

void add_robot_options(CLI::App& verb, RobotArguments& o) {
  verb.add_option("--world", o.world, "world file or shipped name")->capture_default_str();
  verb.add_option("--rig", o.rig, "rig file or shipped name")->capture_default_str();
  verb.add_option("--height-m", o.height_m, "camera height, metres")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb.add_option("--pitch-deg", o.pitch_deg, "camera pitch, degrees; positive is down")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  add_source_options(verb, o.sources);
  verb.add_option("--robot", o.robot,
                  "setting of the robot, such as max_speed_mps=0.5 or wheel_sd=0.01, or exact: "
                  "without errors of odometry (repeatable)");
  verb.add_option("--seed", o.seed, "random seed")->capture_default_str();
}

}  // namespace vernier::cli
