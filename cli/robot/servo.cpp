// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/error_place.h"
#include "calib/base/file_in_progress.h"
#include "calib/base/ordered_parallel.h"
#include "calib/base/output_files.h"
#include "calib/error.h"
#include "calib/interval.h"
#include "calib/statistics/quantile.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"
#include "cli/robot/robot_options.h"
#include "cli/simulation/plan_picture.h"
#include "localise/place.h"
#include "sim/visual_servo.h"
#include "sim/world.h"

namespace vernier::cli {
namespace {

constexpr double to_degrees = 180 / std::numbers::pi;

struct ServoArguments {
  RobotArguments robot;
  std::string goal = "taught";
  ServoOptions servo;
  int trials = 1, threads = 0;
  std::uint32_t first = 0;
  std::string output, plan;
};

std::string trials_csv(const std::vector<ServoTrial>& trials) {
  std::string text =
      "trial,door,goal_x_m,goal_y_m,goal_heading_deg,status,position_error_m,along_m,across_m,"
      "heading_error_deg,image_error_px,lines,frames,time_s,retreats,contacts\n";
  for (const ServoTrial& t : trials) {
    fmt::format_to(std::back_inserter(text),
                   "{},{},{:.6g},{:.6g},{:.6g},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.6g},{},{},{:.6g},"
                   "{},{}\n",
                   t.trial, t.door, t.goal.x_m, t.goal.y_m, t.goal.heading_rad * to_degrees,
                   name(t.status), t.position_error_m, t.along_m, t.across_m,
                   t.heading_error_rad * to_degrees, t.image_error_px, t.lines, t.frames, t.time_s,
                   t.retreats, t.contacts);
  }
  return text;
}

/// Figures over the trials that converged.
struct ServoFigures {
  explicit ServoFigures(const std::vector<ServoTrial>& trials) {
    for (const ServoTrial& t : trials) {
      ++statuses[static_cast<std::size_t>(t.status)];
      if (t.status != ServoStatus::converged) continue;
      position_mm.push_back(1e3 * t.position_error_m);
      heading_deg.push_back(std::abs(t.heading_error_rad) * to_degrees);
      time_s.push_back(t.time_s);
    }
  }

  static double at(const std::vector<double>& values, double p) {
    using namespace vernier::internal;
    return values.empty() ? std::numeric_limits<double>::quiet_NaN()
                          : quantile(values, p, QuantileKind::linear);
  }

  std::array<int, 4> statuses{};
  std::vector<double> position_mm, heading_deg, time_s;
};

Json quantiles_json(const std::vector<double>& values) {
  return {{"median", json_number(ServoFigures::at(values, 0.5))},
          {"p90", json_number(ServoFigures::at(values, 0.9))}};
}

void report(const std::vector<ServoTrial>& trials,
            const ServoArguments& options,
            Session& session) {
  const ServoFigures figures(trials);
  const auto n = static_cast<double>(trials.size());
  const int converged = figures.statuses[0];
  const Interval interval = wilson_interval(converged, n);
  Json json{{"goal", options.goal},
            {"trials", trials.size()},
            {"converged", converged},
            {"converged_interval_95", {interval.low, interval.high}},
            {"timed_out", figures.statuses[1]},
            {"lost", figures.statuses[2]},
            {"failed", figures.statuses[3]},
            {"position_error_mm", quantiles_json(figures.position_mm)},
            {"heading_error_deg", quantiles_json(figures.heading_deg)},
            {"time_s", quantiles_json(figures.time_s)}};
  for (const ServoTrial& t : trials) {
    if (t.status != ServoStatus::failed) continue;
    session.add_trust_warning(
        fmt::format("{} of {} trials failed: {}", figures.statuses[3], trials.size(), t.failure));
    json["failure"] = t.failure;
    break;
  }
  constexpr std::size_t told_apart = 5;  // of fewer, none may arrive by chance
  if (converged == 0 && figures.statuses[3] == 0 && trials.size() >= told_apart) {
    session.add_trust_warning(
        fmt::format("none of {} robots says that it arrived, so nothing is known of its errors",
                    trials.size()));
  }
  std::string text = fmt::format(
      "{} of {} trials converged (95 %: {:.1f} to {:.1f} %); {} timed out, {} lost the door\n",
      converged, trials.size(), 100 * interval.low, 100 * interval.high, figures.statuses[1],
      figures.statuses[2]);
  if (converged > 0) {
    text += fmt::format(
        "of those: {:.1f} mm from the goal (median; 90 %: {:.1f}), heading {:.2f} deg off "
        "({:.2f}), "
        "in {:.1f} s\n",
        ServoFigures::at(figures.position_mm, 0.5), ServoFigures::at(figures.position_mm, 0.9),
        ServoFigures::at(figures.heading_deg, 0.5), ServoFigures::at(figures.heading_deg, 0.9),
        ServoFigures::at(figures.time_s, 0.5));
  }
  session.result(json, text);
}

/// The files of a run, open from its beginning: what cannot be written is known before it.
struct ServoFiles {
  explicit ServoFiles(const ServoArguments& options)
      : trials(files.add_wanted(options.output)), plan(files.add_wanted(options.plan)) {}

  vernier::internal::OutputFiles files;
  vernier::internal::FileInProgress *trials, *plan;
};

void write_files(ServoFiles& files, const World& world, const std::vector<ServoTrial>& trials) {
  if (files.trials) files.trials->append(trials_csv(trials));
  if (files.plan) {
    std::vector<PlanWay> ways;
    for (const ServoTrial& t : trials) {
      const bool arrived = t.status == ServoStatus::converged;
      const std::string label = trials.size() > 3 ? "" : fmt::format("trial {}", t.trial);
      ways.push_back({label, arrived ? "#06c" : "#c22", t.way});
    }
    files.plan->append(plan_svg(world, ways));
  }
  files.files.commit();
}

void run(const ServoArguments& options, Session& session) {
  ServoOptions servo = options.servo;
  servo.goal =
      vernier::internal::with_errors_of("--goal", [&] { return servo_goal(options.goal); });
  for (const std::string* file : {&options.output, &options.plan}) {
    check_output_is_not_input(
        {options.robot.sources.file, find_world(options.robot.world), find_rig(options.robot.rig)},
        *file);
  }
  constexpr std::uint64_t most_trials = std::uint64_t{1} << 31U;  // the others are those of maps
  if (std::uint64_t{options.first} + static_cast<std::uint64_t>(options.trials) > most_trials) {
    throw Error("--trial " + std::to_string(options.first), "and --trials go beyond 2147483647",
                "begin with a smaller number");
  }
  const RobotStage stage(options.robot, session);
  const ServoExperiment experiment = vernier::internal::with_errors_of(options.robot.world, [&] {
    return ServoExperiment(stage.visibility(), stage.rig(), stage.options(), servo);
  });
  ServoFiles files(options);
  std::vector<ServoTrial> trials(static_cast<std::size_t>(options.trials));
  vernier::internal::for_each_index(trials.size(), options.threads, [&](std::size_t i) {
    trials[i] = experiment.run(options.robot.seed, options.first + static_cast<std::uint32_t>(i));
    if (options.plan.empty()) trials[i].way = {};
  });
  write_files(files, stage.world(), trials);
  report(trials, options, session);
}

}  // namespace

void add_servo(CLI::App& app, Session& session) {
  auto o = std::make_shared<ServoArguments>();
  CLI::App* verb = add_verb(
      app, session, "servo",
      "let a simulated robot drive to a place in front of a door by the image error of its frame",
      "vernier servo --world workshop --trials 100 --source lateral_shift_px=3 -o trials.csv\n"
      "  vernier servo --goal model --source calibration=3 --plan servo.svg");
  add_robot_options(*verb, o->robot);
  verb->add_option("--goal", o->goal,
                   "where the desired view comes from: taught (seen there before, in the same "
                   "light), recorded (in other light) or model (computed for the told rig)")
      ->capture_default_str();
  verb->add_option("--door", o->servo.door, "template of the objects to stand in front of")
      ->capture_default_str();
  verb->add_option("--distance-m", o->servo.distance_m, "of the goal from the door, metres")
      ->check(CLI::Range(0.3, 20.0))
      ->capture_default_str();
  verb->add_option("--trials", o->trials, "number of trials, each with its door and start")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_option("--trial", o->first, "number of the first")->capture_default_str();
  verb->add_option("--tolerance-m", o->servo.law.across_tolerance_m,
                   "beside the goal, by the image error: beyond it the robot comes again, metres")
      ->check(CLI::Range(1e-4, 1.0))
      ->capture_default_str();
  verb->add_option("--time-limit-s", o->servo.law.time_limit_s, "of a drive, simulated")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  verb->add_option("--threads", o->threads, "number of threads (0: all)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option("-o,--output", o->output, "one line a trial, CSV");
  verb->add_option("--plan", o->plan, "floor plan with the ways, SVG: red did not converge");
  check_files_written(*verb, {"--output", "--plan"});
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
