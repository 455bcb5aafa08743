// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "calib/error.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/sampler.h"
#include "localise/place.h"
#include "sim/differential_drive.h"
#include "sim/mount_error.h"
#include "sim/noise_free_view.h"
#include "sim/robot/floor_contact.h"
#include "sim/sense.h"
#include "sim/study/standing_place.h"
#include "sim/visibility.h"

namespace vernier::sim {

using namespace localise;
using namespace internal;

namespace {

constexpr std::uint32_t most_frames = 1u << 22;  // of a counter of random numbers

/// The part of the phases that is done after a time.
std::vector<DrivePhase> part(std::vector<DrivePhase> phases, double time_s) {
  for (std::size_t i = 0; i < phases.size(); ++i) {
    DrivePhase& phase = phases[i];
    if (time_s >= phase.duration_s) {
      time_s -= phase.duration_s;
      continue;
    }
    const double share = time_s / phase.duration_s;
    phase.speed1_mps = phase.speed0_mps + share * (phase.speed1_mps - phase.speed0_mps);
    phase.turn1_radps = phase.turn0_radps + share * (phase.turn1_radps - phase.turn0_radps);
    phase.duration_s = time_s;
    phases.resize(i + 1);
  }
  return phases;
}

}  // namespace

struct Robot::Setup {
  Setup(const Visibility& v, const RigEstimate& r, const RobotOptions& o)
      : visibility(v),
        rig(r),
        options(o),
        sensor(r.rig, o.sources),
        obstacles(v.world(), o.mount.height_m + robot_top_m) {
    if (o.sources.calibration > 0) sampler.emplace(r, "rig");
  }

  const Visibility& visibility;
  RigEstimate rig;
  RobotOptions options;
  Sensor sensor;
  Obstacles obstacles;
  std::optional<RigSampler> sampler;
};

Robot::Robot(const Visibility& visibility, const RigEstimate& rig, const RobotOptions& options) {
  check(options.drive, "robot");
  check(options.odometry, "robot");
  if (options.sources.moved > 0) {
    throw Error("sources.moved", "furniture moves in the world, not in a robot's view",
                "give the world of with_moved_furniture, and set it to 0");
  }
  setup_ = std::make_shared<const Setup>(visibility, rig, options);
  told_ = rig.rig;
}

const RobotOptions& Robot::options() const { return setup_->options; }

RobotObservation Robot::reset(std::uint64_t seed, std::uint32_t trial, const Pose2D& start) {
  const RobotOptions& o = setup_->options;
  std::string fault = standing_fault(setup_->visibility, start, o.mount.height_m);
  if (fault.empty() && !fits(start)) {
    fault =
        fmt::format("has a surface nearer than its body's radius of {:g} m", o.drive.body_radius_m);
  }
  if (!fault.empty() || !std::isfinite(start.heading_rad)) {
    throw Error(fmt::format("start at ({:g}, {:g}) m", start.x_m, start.y_m),
                fault.empty() ? "has no finite heading" : fault, "give a free position");
  }
  Rig told = setup_->sampler ? setup_->sampler->sample(o.sources.calibration, seed, trial)
                             : setup_->rig.rig;
  odometry_draw_ = std::make_shared<const OdometryDraw>(o.drive, o.odometry, seed, trial);
  told_ = std::move(told);
  seed_ = seed;
  trial_ = trial;
  frame_ = 0;
  time_s_ = 0;
  pose_ = start;
  odometry_ = {};
  wheels_ = {};
  left_m_ = right_m_ = 0;
  contact_ = false;
  return observe();
}

RobotObservation Robot::step(const DriveCommand& command) {
  const DifferentialDrive& drive = setup_->options.drive;
  if (!odometry_draw_) throw Error("robot", "steps before it stands anywhere", "call reset first");
  check(command, drive, "command");
  if (frame_ + 1 >= most_frames) {
    throw Error("robot", fmt::format("has made {} steps, the most of a trial", frame_),
                "begin another trial");
  }
  ++frame_;
  const std::vector<DrivePhase> believed = wheel_phases(drive, command, wheels_);
  const Obstacles::Advance reached = setup_->obstacles.advance(
      pose_, odometry_draw_->true_phases(believed, frame_), drive.body_radius_m);
  contact_ = reached.contact;
  if (contact_) wheels_ = {};
  pose_ = reached.pose;
  time_s_ += command.duration_s;
  left_m_ = right_m_ = 0;
  for (const DrivePhase& phase : contact_ ? part(believed, reached.time_s) : believed) {
    odometry_ = compose(odometry_, phase.after(phase.duration_s));
    const double way = 0.5 * (phase.speed0_mps + phase.speed1_mps) * phase.duration_s;
    const double turn = 0.5 * (phase.turn0_radps + phase.turn1_radps) * phase.duration_s;
    left_m_ += way - 0.5 * drive.wheel_base_m * turn;
    right_m_ += way + 0.5 * drive.wheel_base_m * turn;
  }
  return observe();
}

bool Robot::fits(const Pose2D& at, double room_m) const {
  const double radius = setup_->options.drive.body_radius_m + room_m;
  return setup_->obstacles.distance_m({at.x_m, at.y_m}, 2 * radius) >= radius;
}

StereoObservation Robot::view_from(const Pose2D& pose, std::uint32_t frame) const {
  const RobotOptions& o = setup_->options;
  NoiseFreeViewOptions looking = look_from(draw_mount(o.mount, o.sources, seed_, trial_));
  looking.with_corners = o.with_corners;
  return setup_->sensor.sense(look(setup_->visibility, setup_->rig.rig, pose, looking),
                              {.seed = seed_, .trial = trial_, .frame = frame});
}

RobotObservation Robot::observe() const {
  const double radius = setup_->options.drive.wheel_radius_m;
  RobotObservation seen;
  seen.frame = frame_;
  seen.time_s = time_s_;
  seen.odometry = odometry_;
  seen.odometry.heading_rad = std::remainder(odometry_.heading_rad, 2 * std::numbers::pi);
  seen.left_wheel_rad = left_m_ / radius;
  seen.right_wheel_rad = right_m_ / radius;
  seen.contact = contact_;
  seen.view = view_from(pose_, frame_);
  return seen;
}

}  // namespace vernier::sim
