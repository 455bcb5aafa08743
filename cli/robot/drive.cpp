// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/file_in_progress.h"
#include "calib/base/output_files.h"
#include "calib/error.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/robot/drive_commands.h"
#include "cli/robot/driving_program.h"
#include "cli/robot/robot_options.h"
#include "cli/simulation/plan_picture.h"
#include "localise/place.h"
#include "localise/trajectory.h"
#include "sim/differential_drive.h"
#include "sim/noise_free_view.h"
#include "sim/robot.h"
#include "sim/world.h"

namespace vernier::cli {
namespace {

constexpr double degree = std::numbers::pi / 180;

struct DriveArguments {
  RobotArguments robot;
  std::string pose, commands, command;
  double time_limit_s = 10;
  int steps = 1000;
  std::uint32_t trial = 0;
  bool corners = false;
  std::string output, truth, odometry, plan;
};

/// A drive as it went.
struct DriveLog {
  vernier::internal::FileInProgress* observations = nullptr;  ///< lines of JSON, if wanted
  std::vector<double> times_s;
  std::vector<Pose2D> truth, odometry;  ///< in the world; odometry begins at the true start
  int contacts = 0;
  double way_m = 0;
  std::string ended = "commands", failure;
};

/// The files of a drive, open from its beginning: what cannot be written is known before it.
struct DriveFiles {
  explicit DriveFiles(const DriveArguments& options)
      : observations(files.add_wanted(options.output)),
        truth(files.add_wanted(options.truth)),
        odometry(files.add_wanted(options.odometry)),
        plan(files.add_wanted(options.plan)) {}

  vernier::internal::OutputFiles files;
  vernier::internal::FileInProgress *observations, *truth, *odometry, *plan;
};

using NextCommand = std::function<std::optional<DriveCommand>(const RobotObservation&)>;

void note(const Robot& robot, const RobotObservation& seen, DriveLog& log) {
  if (!seen.view.failure.empty()) {
    throw Error("--source command", seen.view.failure, "correct the program (docs/own-source.md)");
  }
  if (log.observations) log.observations->append(observation_json(seen).dump() + "\n");
  log.times_s.push_back(seen.time_s);
  if (!log.truth.empty()) log.way_m += distance_m(log.truth.back(), robot.true_pose());
  log.truth.push_back(robot.true_pose());
  log.odometry.push_back(compose(log.truth.front(), seen.odometry));
  log.contacts += seen.contact;
}

DriveLog drive(Robot& robot,
               const DriveArguments& options,
               const NextCommand& next,
               RobotObservation seen,
               vernier::internal::FileInProgress* observations) {
  DriveLog log;
  log.observations = observations;
  note(robot, seen, log);
  for (int step = 0;; ++step) {
    // A program is not asked for a command that nobody drives; a file may end there.
    const bool is_last = step == options.steps;
    const std::optional<DriveCommand> command =
        is_last && !options.command.empty() ? DriveCommand{} : next(seen);
    if (!command) break;
    if (is_last) {
      log.ended = "steps";
      break;
    }
    seen = robot.step(*command);
    note(robot, seen, log);
  }
  return log;
}

DriveLog drive_by_program(Robot& robot,
                          const DriveArguments& options,
                          RobotObservation seen,
                          vernier::internal::FileInProgress* observations) {
  DrivingProgram program(options.command, options.time_limit_s, robot.told_rig(), robot.options());
  DriveLog log = drive(
      robot, options, [&](const RobotObservation& o) { return program.command(o); },
      std::move(seen), observations);
  log.failure = program.failure();
  if (log.ended != "steps") log.ended = log.failure.empty() ? "done" : "failed";
  return log;
}

std::string trajectory_text(const std::vector<double>& times_s,
                            const std::vector<Pose2D>& poses,
                            const CameraMount& mount) {
  std::vector<TimedPose> trajectory;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    trajectory.push_back({times_s[i], T_left_world(poses[i], mount).inverse()});
  }
  return tum_text(trajectory);
}

void write_files(DriveFiles& files, const RobotStage& stage, const DriveLog& log) {
  const CameraMount& mount = stage.options().mount;
  if (files.truth) files.truth->append(trajectory_text(log.times_s, log.truth, mount));
  if (files.odometry) files.odometry->append(trajectory_text(log.times_s, log.odometry, mount));
  if (files.plan) {
    files.plan->append(plan_svg(
        stage.world(), {{"true way", "#06c", log.truth}, {"by odometry", "#e80", log.odometry}}));
  }
  files.files.commit();
}

Json pose_json(const Pose2D& p) {
  return {p.x_m, p.y_m, std::remainder(p.heading_rad, 2 * std::numbers::pi) / degree};
}

void report(const DriveLog& log, Session& session) {
  const Pose2D &truth = log.truth.back(), &odometry = log.odometry.back();
  const double off_m = distance_m(truth, odometry);
  const double off_deg = heading_difference_rad(odometry, truth) / degree;
  if (!log.failure.empty()) {
    session.add_trust_warning("the program of --command " + log.failure + " after " +
                              std::to_string(log.truth.size() - 1) + " steps");
  }
  Json json{{"steps", log.truth.size() - 1},
            {"time_s", log.times_s.back()},
            {"way_m", log.way_m},
            {"contacts", log.contacts},
            {"ended", log.ended},
            {"end", pose_json(truth)},
            {"odometry_end", pose_json(odometry)},
            {"odometry_error_m", off_m},
            {"odometry_error_deg", off_deg}};
  if (!log.failure.empty()) json["failure"] = log.failure;
  const Json end = pose_json(truth);
  session.result(
      json,
      fmt::format("{} steps in {:.1f} s, {:.2f} m driven, {} with contact; ended by {}\n"
                  "now at ({:.3f}, {:.3f}) m heading {:.2f} deg; odometry is off by {:.3f} m and "
                  "{:.2f} deg\n",
                  log.truth.size() - 1, log.times_s.back(), log.way_m, log.contacts, log.ended,
                  truth.x_m, truth.y_m, end[2].get<double>(), off_m, off_deg));
}

void run(const DriveArguments& options, const CLI::App& verb, Session& session) {
  if (options.commands.empty() == options.command.empty()) {
    throw Error("drive",
                options.commands.empty() ? "no commands are given" : "commands and a program",
                "give either --commands or --command");
  }
  if (options.command.empty()) {
    refuse_options(verb, std::array{"--time-limit-s"}, "there is no program, --command");
  }
  for (const std::string* file :
       {&options.output, &options.truth, &options.odometry, &options.plan}) {
    check_output_is_not_input({options.commands, options.robot.sources.file,
                               find_world(options.robot.world), find_rig(options.robot.rig)},
                              *file);
  }
  const std::vector<double> at = parse_numbers(options.pose, 3, "--pose");
  const RobotStage stage(options.robot, session);
  RobotOptions robot_options = stage.options();
  robot_options.with_corners = options.corners;
  std::vector<DriveCommand> commands;
  if (!options.commands.empty()) commands = read_commands(options.commands, robot_options.drive);
  Robot robot(stage.visibility(), stage.rig(), robot_options);
  DriveFiles files(options);
  RobotObservation seen = vernier::internal::with_errors_of("--pose " + options.pose, [&] {
    return robot.reset(options.robot.seed, options.trial, {at[0], at[1], at[2] * degree});
  });
  std::size_t done = 0;
  const NextCommand from_file = [&](const RobotObservation&) -> std::optional<DriveCommand> {
    if (done == commands.size()) return std::nullopt;
    return commands[done++];
  };
  const DriveLog log = options.command.empty()
                           ? drive(robot, options, from_file, std::move(seen), files.observations)
                           : drive_by_program(robot, options, std::move(seen), files.observations);
  if (log.ended == "steps" && options.command.empty()) {
    session.warn(fmt::format("{}: holds {} commands, of which --steps {} were driven",
                             options.commands, commands.size(), options.steps));
  }
  write_files(files, stage, log);
  report(log, session);
}

}  // namespace

void add_drive(CLI::App& app, Session& session) {
  auto o = std::make_shared<DriveArguments>();
  CLI::App* verb = add_verb(
      app, session, "drive",
      "let a simulated robot drive by commands, from a file or from a program that sees what it "
      "sees",
      "vernier drive --pose 10,7.5,0 --commands commands.csv -o seen.jsonl --plan drive.svg\n"
      "  vernier drive --pose 10,7.5,0 --command 'python3 controller.py' --truth truth.txt");
  add_robot_options(*verb, o->robot);
  verb->add_option("--pose", o->pose, "start: x,y,heading_deg (metres; heading from +x)")
      ->required();
  verb->add_option("--commands", o->commands,
                   "file of commands, JSON lines or CSV: speed_mps, turn_radps, duration_s; - is "
                   "standard input");
  verb->add_option("--command", o->command,
                   "program that gets observations as lines of JSON and answers with commands");
  verb->add_option("--time-limit-s", o->time_limit_s, "of the program, for a command")
      ->check(CLI::Range(1e-3, 86400.0))
      ->capture_default_str();
  verb->add_option("--steps", o->steps, "most steps of the drive")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_option("--trial", o->trial, "number of the random draw for this seed")
      ->capture_default_str();
  verb->add_flag("--corners", o->corners, "observations have corners too");
  verb->add_option("-o,--output", o->output, "observations, a line of JSON each");
  verb->add_option("--truth", o->truth, "true trajectory of the left camera, TUM format");
  verb->add_option("--odometry", o->odometry, "the same by odometry, from the true start");
  verb->add_option("--plan", o->plan, "floor plan with both ways, SVG");
  check_files_written(*verb, {"--output", "--truth", "--odometry", "--plan"});
  verb->callback(
      [o, verb, &session] { session.action = [=, &session] { run(*o, *verb, session); }; });
}

}  // namespace vernier::cli
