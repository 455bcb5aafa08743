// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/robot/drive_commands.h"

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "fuzz/program_answer.h"
#include "sim/differential_drive.h"

namespace vernier::fuzz {
namespace {

using sim::DifferentialDrive;
using sim::DriveCommand;

void check_command(const DriveCommand& command) {
  require(std::isfinite(command.speed_mps) && std::isfinite(command.turn_radps),
          "speeds are finite");
  require(command.duration_s > 0, "a command lasts");
  const auto again = accepted([&] {
    check(command, DifferentialDrive{}, "again");
    return true;
  });
  require(again.has_value(), "what is accepted is within the limits");
}

void run_drive_commands(std::string_view bytes) {
  const auto commands =
      accepted([&] { return cli::read_commands(input_file(bytes, "commands.csv").string(), {}); });
  if (!commands) return;
  require(!commands->empty(), "what is accepted holds a command");
  for (const DriveCommand& command : *commands) check_command(command);
}

void run_drive_answer(std::string_view bytes) {
  const auto command =
      accepted_answer(bytes, [](const auto& said) { return cli::parse_drive_answer(said, {}); });
  if (command && *command) check_command(**command);
}

std::vector<std::string> drive_commands_seeds() {
  return {"speed_mps,turn_radps,duration_s\n0.3,0.1,0.5\n# a comment\n0,-0.5,1\n",
          "left_mps, right_mps, duration_s\n0.1 0.2 0.5\n",
          "{\"speed_mps\":0.3,\"turn_radps\":0,\"duration_s\":1}\n\n"
          "{\"left_mps\":0.1,\"right_mps\":-0.1,\"duration_s\":0.25}\n"};
}

std::vector<std::string> drive_answer_seeds() {
  return {R"({"speed_mps":0.3,"turn_radps":0.1,"duration_s":0.5})",
          R"({"left_mps":0.3,"right_mps":0.1,"duration_s":0.5})", R"({"done":true})"};
}

const Registered registered_drive_answer{
    {"drive_answer", 500, "drive", run_drive_answer, drive_answer_seeds}};
const Registered registered_drive_commands{
    {"drive_commands", 1000, "drive", run_drive_commands, drive_commands_seeds}};

}  // namespace
}  // namespace vernier::fuzz
