// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/robot/drive_commands.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/base/json_node.h"
#include "calib/base/json_reader.h"
#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/error.h"
#include "cli/program/session.h"
#include "sim/differential_drive.h"

namespace vernier::cli {

using namespace vernier::internal;

namespace {

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
  throw Error(place, "begins neither with all columns of a command nor with JSON", remedy);
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

std::optional<DriveCommand> parse_drive_answer(const JsonNode& answer,
                                               const DifferentialDrive& drive) {
  const bool done = answer.has("done") && answer.size() == 1 && answer.at("done").json() == true;
  if (done) return std::nullopt;
  return command_of(answer, drive);
}

}  // namespace vernier::cli
