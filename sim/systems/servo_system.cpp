// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/systems/servo_system.h"

#include <cstdint>
#include <memory>
#include <utility>

#include "calib/base/thread_clock.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/moved_furniture.h"
#include "sim/robot.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_under_test.h"
#include "sim/visual_servo.h"

namespace vernier::sim::internal {

using namespace vernier::internal;
using localise::LocalisationStatus;

namespace {

LocalisationStatus status_of(ServoStatus status) {
  switch (status) {
    case ServoStatus::converged:
      return LocalisationStatus::answered;
    case ServoStatus::timed_out:
      return LocalisationStatus::unsure;
    case ServoStatus::lost:
      return LocalisationStatus::no_match;
    case ServoStatus::failed:
      break;
  }
  return LocalisationStatus::failed;
}

RobotOptions robot_of(const ExperimentSettings& settings) {
  RobotOptions robot;
  robot.sources = settings.sources;
  robot.sources.moved = 0;  // in the world
  robot.mount = settings.mount;
  return robot;
}

ServoOptions servo_of(const SystemSettings& system) {
  ServoOptions servo;
  servo.goal = servo_goal(system.text("goal"));
  servo.door = system.text("door");
  servo.distance_m = system.number("distance_m");
  servo.law.across_tolerance_m = system.number("tolerance_m");
  servo.law.time_limit_s = system.number("time_limit_s");
  return servo;
}

class ServoSystem : public SystemUnderTest {
 public:
  explicit ServoSystem(const SystemSetup& setup)
      : settings_(setup.cell.system),
        seed_(setup.cell.experiment.seed),
        changed_(setup.changed),
        servo_(changed_ ? changed_->visibility : setup.visibility,
               setup.rig,
               robot_of(setup.cell.experiment),
               servo_of(setup.cell.system)) {}

  TrialResult run(std::uint32_t trial) override {
    const ThreadClock clock;
    const ServoTrial drive = servo_.run(seed_, trial);
    const double cpu_ms = clock.cpu_ms(), wall_ms = clock.wall_ms();
    TrialResult result = failed_trial(settings_, trial, drive.failure);
    result.status = status_of(drive.status);
    result.truth = drive.start;
    result.cpu_ms = cpu_ms;
    result.wall_ms = wall_ms;
    if (drive.status != ServoStatus::converged && drive.status != ServoStatus::timed_out) {
      return result;
    }
    result.error = drive.position_error_m;
    result.node_error_m = 0;
    result.heading_error_rad = drive.heading_error_rad;
    result.answer = result.node = drive.end;
    result.measured = {drive.along_m,
                       drive.across_m,
                       drive.image_error_px,
                       static_cast<double>(drive.frames),
                       static_cast<double>(drive.contacts),
                       static_cast<double>(drive.retreats),
                       drive.time_s};
    return result;
  }

 private:
  const SystemSettings& settings_;
  std::uint64_t seed_;
  std::shared_ptr<const ChangedWorld> changed_;
  ServoExperiment servo_;
};

}  // namespace

SystemKind servo_kind() {
  using Type = SystemOption::Type;
  return {.name = "servoing",
          .noun = "a servoing robot",
          .error_name = "position_error_m",
          .error_title = "position error",
          .unit = "m",
          .success_error = 0.1,
          .options = {{.name = "goal",
                       .type = Type::word,
                       .usual = "taught",
                       .words = {"taught", "recorded", "model"}},
                      {.name = "door", .type = Type::text, .usual = "door_frame"},
                      {.name = "distance_m", .usual = "1.8", .low = 0.1, .high = 100},
                      {.name = "tolerance_m", .usual = "0.02", .low = 0.001, .high = 10},
                      {.name = "time_limit_s", .usual = "60", .low = 0.1, .high = 3600}},
          .measured = {{"along_m", "end before or behind the goal, along its axis, m", true},
                       {"across_m", "end beside the goal, m", true},
                       {"image_error_px",
                        "RMS distance of the door's lines in the last image from the goal's, px"},
                       {"frames", "pairs of images taken"},
                       {"contacts", "touches of an obstacle"},
                       {"retreats", "times that it drove back to begin again"},
                       {"time_s", "of the drive, s"}},
          .sections = {"world", "sources", "camera", "one_at_a_time"},
          .sources = SourcesUsed::all,
          .make = [](const SystemSetup& setup) { return std::make_unique<ServoSystem>(setup); }};
}

}  // namespace vernier::sim::internal
