// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/robot/drive_commands.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/answering_program.h"
#include "calib/base/json_node.h"
#include "calib/base/json_reader.h"
#include "calib/base/program_run.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "calib/formats/rig_json.h"
#include "calib/rig.h"
#include "cli/program/session.h"
#include "cli/simulation/observation_json.h"
#include "sim/differential_drive.h"
#include "sim/robot.h"
#include "sim/sense.h"
#include "sim/uncertainty_source.h"
#include "stereo/segment.h"

namespace vernier::cli {

using namespace vernier::internal;

namespace {

constexpr int protocol_version = 1;
constexpr double start_s = 10;  // to get ready, in addition to the time limit of an observation

constexpr std::array<std::array<std::string_view, 3>, 2> forms{
    {{"speed_mps", "turn_radps", "duration_s"}, {"left_mps", "right_mps", "duration_s"}}};

const char* const remedy =
    "give speed_mps, turn_radps and duration_s, or left_mps, right_mps and duration_s";

DriveCommand command_of(bool of_wheels,
                        const std::array<double, 3>& v,
                        const DifferentialDrive& drive,
                        const std::string& place) {
  const DriveCommand command =
      of_wheels ? wheel_command(drive, v[0], v[1], v[2]) : DriveCommand{v[0], v[1], v[2]};
  check(command, drive, place);
  return command;
}

DriveCommand command_of(const JsonNode& node, const DifferentialDrive& drive) {
  if (!node.json().is_object()) throw Error(node.place(), "is no JSON object", remedy);
  const bool of_wheels = node.has("left_mps") || node.has("right_mps");
  const auto& names = forms[of_wheels];
  for (const auto& [key, value] : node.json().items()) {
    if (std::find(names.begin(), names.end(), key) == names.end()) {
      throw Error(node.place(), "has an unknown field " + in_quotes(key), remedy);
    }
  }
  std::array<double, 3> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = node.at(std::string(names[i])).number();
  }
  return command_of(of_wheels, values, drive, node.place());
}

constexpr const char* separators = ", \t";  // blanks beside a comma are none of the fields

/// Which of the forms a header of CSV has.
bool header_of_wheels(std::string_view line, const std::string& place) {
  const std::vector<std::string_view> names = split_fields(line, separators);
  for (std::size_t form = 0; form < forms.size(); ++form) {
    if (std::equal(names.begin(), names.end(), forms[form].begin(), forms[form].end())) return form;
  }
  throw Error(place, "begins neither with a header nor with JSON", remedy);
}

DriveCommand command_of_csv(std::string_view line,
                            bool of_wheels,
                            const DifferentialDrive& drive,
                            const std::string& place) {
  const std::vector<std::string_view> fields = split_fields(line, separators);
  std::array<double, 3> values{};
  if (fields.size() != values.size()) throw Error(place, "has not 3 fields", remedy);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = parse_real(fields[i], place, forms[of_wheels][i]);
  }
  return command_of(of_wheels, values, drive, place);
}

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

std::vector<DriveCommand> read_commands(const std::string& file, const DifferentialDrive& drive) {
  constexpr std::size_t most = 1'000'000;
  TextLines lines(file == "-" ? "/dev/stdin" : file);
  std::vector<DriveCommand> commands;
  std::optional<bool> csv_of_wheels;
  std::string_view line;
  while (lines.next(line)) {
    if (line.find_first_not_of(" \t") == std::string_view::npos || line.front() == '#') continue;
    if (commands.size() == most) {
      throw Error(lines.place(), "is beyond a million commands", "give fewer");
    }
    if (line.front() == '{') {
      const Json json = parse_json_line(line, lines.place());
      commands.push_back(command_of(JsonNode(json, lines.place() + ":"), drive));
    } else if (!csv_of_wheels) {
      csv_of_wheels = header_of_wheels(line, lines.place());
    } else {
      commands.push_back(command_of_csv(line, *csv_of_wheels, drive, lines.place()));
    }
  }
  if (commands.empty()) throw Error(file, "holds no command", remedy);
  return commands;
}

std::optional<DriveCommand> parse_drive_answer(std::string_view line,
                                               const DifferentialDrive& drive) {
  const Json json = parse_json(line, "answer");
  const JsonNode node(json, "answer:");
  if (node.has("done") && json.size() == 1 && json["done"] == true) return std::nullopt;
  return command_of(node, drive);
}

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
  const auto take = [&](std::string_view line) { chosen = parse_drive_answer(line, drive_); };
  const auto question = [&] { return observation_json(seen).dump() + "\n"; };
  if (!program_.ask(question, take)) failure_ = program_.failure();
  return failure_.empty() ? chosen : std::nullopt;
}

}  // namespace vernier::cli
