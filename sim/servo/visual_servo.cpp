// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/visual_servo.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/draw_sources.h"
#include "calib/statistics/random.h"
#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/robot.h"
#include "sim/servo/desired_view.h"
#include "sim/servo/door_search.h"
#include "sim/servo/goal_alignment.h"
#include "sim/servo/servo_control.h"
#include "sim/servo/stereo_line.h"
#include "sim/study/standing_place.h"
#include "sim/visibility.h"
#include "sim/world.h"

namespace vernier::sim {

using namespace localise;
using namespace internal;
using namespace vernier::internal;

namespace {

constexpr std::array<std::string_view, 3> goal_names{"taught", "recorded", "model"};
constexpr std::array<std::string_view, 4> status_names{"converged", "timed_out", "lost", "failed"};

constexpr double room_m = 0.1;  // around the body at the goal and on the straight way to it

void need(bool holds, const char* what, const char* remedy) {
  if (!holds) throw Error("servoing", what, remedy);
}

void check_options(const ServoOptions& o) {
  const auto positive = [](double x) { return x > 0 && x <= 100; };
  need(positive(o.distance_m), "the distance from the door is not above 0 and at most 100 m",
       "correct it");
  need(o.nearest_back_m >= 0 && o.farthest_back_m >= o.nearest_back_m && o.farthest_back_m <= 10 &&
           o.aside_m >= 0 && o.aside_m <= 5 && o.turned_rad >= 0 && o.turned_rad <= 1.5,
       "the range of starts is none", "give 0 to 10 m behind, 5 m aside and 1.5 rad at most");
  const ServoLaw& l = o.law;
  for (const double x : {l.frame_s, l.approach_per_s, l.bearing_per_s, l.curve, l.settle_per_s,
                         l.fastest_mps, l.fastest_radps, l.across_tolerance_m, l.retreat_m}) {
    need(positive(x), "a number of the law is not above 0 and at most 100", "correct it");
  }
  need(l.fix_share > 0 && l.fix_share <= 1, "fix_share is not above 0 and at most 1", "correct it");
  need(l.time_limit_s > 0 && l.time_limit_s <= 3600,
       "the time limit is not above 0 and at most 1 h", "correct it");
}

/// On the y side of the object's frame, facing it.
Pose2D goal_before(const WorldObject& door, double distance_m) {
  const double c = std::cos(door.yaw_rad), s = std::sin(door.yaw_rad);
  return {door.centre_m.x() - s * distance_m, door.centre_m.y() + c * distance_m,
          std::atan2(-c, s)};
}

/// Slowed down, on the same arc, to what the wheels may run.
DriveCommand as_fast_as_wheels(const DriveCommand& command, const DifferentialDrive& drive) {
  const double fastest =
      std::abs(command.speed_mps) + 0.5 * drive.wheel_base_m * std::abs(command.turn_radps);
  const double share = std::min(1.0, drive.max_speed_mps / std::max(fastest, 1e-12));
  return {share * command.speed_mps, share * command.turn_radps, command.duration_s};
}

/// One drive, from the first view to the last.
class ServoDrive {
 public:
  ServoDrive(Robot& robot, const DesiredView& desired, const ServoOptions& options)
      : robot_(robot), desired_(desired), options_(options) {}

  void run(RobotObservation seen, ServoTrial& trial) {
    const ServoOptions& o = options_;
    if (!seen.view.failure.empty()) return fail(seen.view.failure, trial);
    constexpr double more_m = 0.1, more_rad = 0.05;  // of the search than the start's range
    const auto found =
        find_goal(desired_, see_all(robot_.told_rig(), seen.view.segments),
                  {std::max(0.0, o.nearest_back_m - more_m), o.farthest_back_m + more_m,
                   o.aside_m + more_m, o.turned_rad + more_rad});
    if (!found) return;
    ServoControl control(*found, o.law);
    LineTracker tracker(desired_, *found);
    for (int unseen = 0; unseen < most_unseen;) {
      unseen = take(seen, control, tracker, trial) ? 0 : unseen + 1;
      const auto command = control.next(unseen == 0, seen.contact);
      trial.retreats = control.retreats();
      trial.status = command ? ServoStatus::timed_out : ServoStatus::converged;
      if (!command || seen.time_s + o.law.frame_s > o.law.time_limit_s) return;
      const double half = 0.5 * robot_.told_rig().cameras[0].size_px.x() / desired_.focal_px;
      seen = robot_.step(as_fast_as_wheels(kept_in_view(*command, desired_, control.goal(), half),
                                           robot_.options().drive));
      trial.way.push_back(robot_.true_pose());
      trial.frames = static_cast<int>(seen.frame);
      trial.time_s = seen.time_s;
      trial.contacts += seen.contact;
      if (!seen.view.failure.empty()) return fail(seen.view.failure, trial);
    }
    trial.status = ServoStatus::lost;
  }

 private:
  static constexpr int most_unseen = 12;  // views in a row

  /// Whether the door was seen.
  bool take(const RobotObservation& seen,
            ServoControl& control,
            LineTracker& tracker,
            ServoTrial& trial) {
    const Pose2D step = relative(seen.odometry, std::exchange(odometry_, seen.odometry));
    control.move(step);
    const auto lines = see_all(robot_.told_rig(), seen.view.segments);
    const auto fix = tracker.track(lines, step, control.goal());
    if (!fix) return false;
    control.correct(fix->goal);
    trial.image_error_px = fix->image_error_px;
    return true;
  }

  static void fail(const std::string& why, ServoTrial& trial) {
    trial.status = ServoStatus::failed;
    trial.failure = why;
  }

  Robot& robot_;
  const DesiredView& desired_;
  const ServoOptions& options_;
  Pose2D odometry_;
};

/// Those with an object, in quotes.
std::string template_names(const World& world) {
  std::set<std::string> names;
  for (const WorldObject& object : world.objects) {
    if (!object.template_name.empty()) names.insert('"' + object.template_name + '"');
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string_view name(ServoGoal goal) { return goal_names.at(static_cast<std::size_t>(goal)); }
std::string_view name(ServoStatus s) { return status_names.at(static_cast<std::size_t>(s)); }

ServoGoal servo_goal(std::string_view name) {
  const auto found = std::find(goal_names.begin(), goal_names.end(), name);
  if (found == goal_names.end()) {
    throw Error(std::string(name), "is no kind of goal", "use taught, recorded or model");
  }
  return static_cast<ServoGoal>(found - goal_names.begin());
}

ServoExperiment::ServoExperiment(const Visibility& visibility,
                                 const RigEstimate& rig,
                                 const RobotOptions& robot,
                                 const ServoOptions& options)
    : visibility_(visibility), rig_(rig), robot_(visibility, rig, robot), options_(options) {
  check_options(options);
  const Pose& T = rig.rig.T_camera_first[1];
  const Eigen::Vector3d baseline = T.R.transpose() * T.t;
  need(std::abs(baseline.x()) > std::abs(baseline.y()),
       "the baseline is 45° or more from level, and stereo cannot place upright lines along it",
       "use a rig with cameras side by side");
  const World& world = visibility.world();
  bool known = false;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.objects[i].template_name != options.door) continue;
    known = true;
    const Pose2D goal = goal_before(world.objects[i], options.distance_m);
    if (!has_starts(goal) || !standing_fault(visibility, goal, robot.mount.height_m).empty()) {
      continue;
    }
    doors_.push_back(static_cast<int>(i));
    goals_.push_back(goal);
  }
  if (doors_.empty()) {
    if (known) {
      throw Error(options.door,
                  fmt::format("has no free place {:g} m in front of it and behind that",
                              options.distance_m),
                  "give another distance");
    }
    const std::string names = template_names(world);
    throw Error(options.door, "is no template of an object in this world",
                names.empty() ? "it has none, as worlds that were imported: take one that has"
                              : "name one of " + names);
  }
}

bool ServoExperiment::is_way(const Pose2D& goal, double back_m, double aside_m) const {
  const double height = robot_.options().mount.height_m;
  const Pose2D start = compose(goal, {-back_m, aside_m, 0});
  bool free = visibility_.sees({goal.x_m, goal.y_m, height}, {start.x_m, start.y_m, height});
  constexpr int places = 30;
  for (int i = 0; i <= places && free; ++i) {
    const double share = static_cast<double>(i) / places;
    free = robot_.fits(compose(goal, {-share * back_m, share * aside_m, 0}), room_m);
  }
  return free;
}

bool ServoExperiment::has_starts(const Pose2D& goal) const {
  constexpr int steps = 10, fewest = 5;  // of 121
  const double depth = options_.farthest_back_m - options_.nearest_back_m;
  int free = 0;
  for (int i = 0; i <= steps; ++i) {
    for (int k = 0; k <= steps; ++k) {
      free += is_way(goal, options_.nearest_back_m + depth * i / steps,
                     options_.aside_m * (2.0 * k / steps - 1));
    }
  }
  return free >= fewest;
}

Pose2D ServoExperiment::draw_start(const Pose2D& goal,
                                   std::uint64_t seed,
                                   std::uint32_t trial) const {
  RandomStream draws({.seed = seed,
                      .trial = trial,
                      .feature = 1,
                      .source = static_cast<std::uint32_t>(DrawSource::servo_start)});
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const double back = draws.uniform(options_.nearest_back_m, options_.farthest_back_m);
    const double aside = draws.uniform(-options_.aside_m, options_.aside_m);
    const double turned = draws.uniform(-options_.turned_rad, options_.turned_rad);
    if (is_way(goal, back, aside)) return compose(goal, {-back, aside, turned});
  }
  throw Error(
      "servoing",
      fmt::format("no free start behind ({:.2f}, {:.2f}) m in 1000 draws", goal.x_m, goal.y_m),
      "give another distance or range of starts");
}

ServoTrial ServoExperiment::run(std::uint64_t seed, std::uint32_t trial) const {
  ServoTrial result;
  result.trial = trial;
  RandomStream draws({.seed = seed,
                      .trial = trial,
                      .source = static_cast<std::uint32_t>(DrawSource::servo_start)});
  const auto chosen = draws.below(static_cast<std::uint32_t>(doors_.size()));
  result.door = doors_[chosen];
  result.goal = goals_[chosen];
  result.start = result.end = draw_start(result.goal, seed, trial);
  Robot robot = robot_;
  RobotObservation seen = robot.reset(seed, trial, result.start);
  result.way.push_back(result.start);
  const auto desired = desired_view(robot, {visibility_, rig_, result.door, result.goal},
                                    options_.goal, {seed, trial}, result.failure);
  if (!result.failure.empty()) {
    result.status = ServoStatus::failed;
  } else {
    result.lines = static_cast<int>(desired.lines.size());
    ServoDrive(robot, desired, options_).run(std::move(seen), result);
  }
  result.end = robot.true_pose();
  const Pose2D off = relative(result.end, result.goal);
  result.along_m = off.x_m;
  result.across_m = off.y_m;
  result.heading_error_rad = off.heading_rad;
  result.position_error_m = std::hypot(off.x_m, off.y_m);
  return result;
}

}  // namespace vernier::sim
