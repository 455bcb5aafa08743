// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/robot/driving_program.h"

#include <optional>
#include <string>

#include "calib/base/answering_program.h"
#include "calib/base/json_node.h"
#include "calib/base/program_run.h"
#include "calib/formats/rig_json.h"
#include "calib/rig.h"
#include "cli/program/session.h"
#include "cli/robot/drive_commands.h"
#include "cli/simulation/observation_json.h"
#include "sim/differential_drive.h"
#include "sim/robot.h"
#include "sim/sense.h"
#include "sim/uncertainty_source.h"
#include "stereo/segment.h"

namespace vernier::cli {

using namespace vernier::internal;

namespace {

constexpr int protocol_version = 2;
constexpr double start_s = 10;  // to get ready, in addition to the time limit of an observation

std::string hello_line(const Rig& told, const RobotOptions& robot) {
  const Json json{
      {"vernier_robot", protocol_version},
      {"cameras", rig_json::cameras_json(told)},
      {"mount", {{"height_m", robot.mount.height_m}, {"pitch_rad", robot.mount.pitch_rad}}},
      {"wheel_base_m", robot.drive.wheel_base_m},
      {"wheel_radius_m", robot.drive.wheel_radius_m},
      {"max_speed_mps", robot.drive.max_speed_mps},
      {"max_acceleration_mps2", robot.drive.max_acceleration_mps2},
      {"body_radius_m", robot.drive.body_radius_m}};
  return json.dump() + "\n";
}

}  // namespace

Json observation_json(const RobotObservation& seen) {
  Json json{{"frame", seen.frame},
            {"time_s", seen.time_s},
            {"odometry",
             {{"x_m", seen.odometry.x_m},
              {"y_m", seen.odometry.y_m},
              {"heading_rad", seen.odometry.heading_rad}}},
            {"wheels_rad", {seen.left_wheel_rad, seen.right_wheel_rad}},
            {"contact", seen.contact},
            {"edges", Json::array()},
            {"left_only_px", Json::array()}};
  for (const StereoSegment& s : seen.view.segments) {
    json["edges"].push_back(
        {{"left_px", segment_json(s.left)}, {"right_px", segment_json(s.right)}});
  }
  for (const ImageSegment& s : seen.view.left_only) {
    json["left_only_px"].push_back(segment_json(s));
  }
  if (seen.view.corners.empty()) return json;
  json["corners"] = Json::array();
  for (const SensedCorner& c : seen.view.corners) {
    json["corners"].push_back({{"left_px", {c.pixel_px[0].x(), c.pixel_px[0].y()}},
                               {"right_px", {c.pixel_px[1].x(), c.pixel_px[1].y()}}});
  }
  return json;
}

DrivingProgram::DrivingProgram(const std::string& command,
                               double time_limit_s,
                               const Rig& told,
                               const RobotOptions& robot)
    : drive_(robot.drive),
      program_(command_words(command, "--command"),
               {[hello = hello_line(told, robot)] { return hello; }, "the robot",
                time_limit_s + start_s},
               time_limit_s) {}

std::optional<DriveCommand> DrivingProgram::command(const RobotObservation& seen) {
  std::optional<DriveCommand> chosen;
  const auto take = [&](const JsonNode& said) { chosen = parse_drive_answer(said, drive_); };
  const auto question = [&] { return observation_json(seen); };
  if (!program_.ask(question, take)) failure_ = program_.failure();
  return failure_.empty() ? chosen : std::nullopt;
}

}  // namespace vernier::cli
