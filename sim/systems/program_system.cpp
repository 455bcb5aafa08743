// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/systems/program_system.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/answering_program.h"
#include "calib/base/error_place.h"
#include "calib/base/json_node.h"
#include "calib/base/program_run.h"
#include "calib/base/thread_clock.h"
#include "calib/error.h"
#include "calib/formats/rig_json.h"
#include "calib/rig.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/study_file.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_under_test.h"
#include "sim/told_rigs.h"

namespace vernier::sim::internal {

using localise::LocalisationStatus;
using namespace vernier::internal;
using Json = rig_json::Json;

namespace {

constexpr int system_protocol = 2;
constexpr double ready_s = 10;  ///< to get ready

/// The conversation's first line.
std::string hello_line(const StudyCell& cell) {
  Json parameters = Json::object();
  for (const auto& [name, value] : cell.system.parameters) parameters[name] = Json::parse(value);
  const Json hello{{"vernier_system", system_protocol},
                   {"parameters", parameters},
                   {"measured", cell.system.measured_names},
                   {"seed", cell.experiment.seed}};
  return hello.dump() + "\n";
}

std::unique_ptr<AnsweringProgram> started(const StudyCell& cell) {
  const double limit_s = cell.system.number("time_limit_s");
  std::vector<std::string> words = command_words(cell.system.text("command"), "system.command");
  const ProgramStart start{[&cell] { return hello_line(cell); }, "the parameters",
                           ready_s + limit_s};
  return with_errors_of("system.command", [&] {
    return std::make_unique<AnsweringProgram>(std::move(words), start, limit_s);
  });
}

/// A number whose square is one.
double bounded_number(const JsonNode& node) {
  constexpr double most = 1e150;
  const double value = node.number();
  if (!(std::abs(value) <= most)) throw Error(node.place(), "is beyond 1e150", "use another unit");
  return value;
}

/// True unless the program says that it has no answer.
bool has_answered(const JsonNode& answer) {
  if (!answer.has("answered")) return true;
  const JsonNode said = answer.at("answered");
  if (!said.json().is_boolean()) throw Error(said.place(), "is not a boolean", "use true or false");
  return said.json().get<bool>();
}

class ProgramSystem : public SystemUnderTest {
 public:
  explicit ProgramSystem(const SystemSetup& setup)
      : cell_(setup.cell),
        truth_(setup.rig.rig),
        true_rig_(rig_json::cameras_json(setup.rig.rig)),
        told_(rigs_told(setup)),
        program_(started(setup.cell)) {}

  TrialResult run(std::uint32_t trial) override {
    const ToldRig told = told_ ? told_->told(trial) : ToldRig{truth_, {}};
    TrialResult result = failed_trial(cell_.system, trial, told.failure);
    if (!told.failure.empty()) return result;
    const double cpu_s = program_->cpu_s();
    const ThreadClock clock;
    const auto question = [&] { return question_json(trial, told.rig); };
    const auto take = [&](const JsonNode& answer) {
      parse_system_answer(answer, cell_.system, result);
    };
    if (program_->ask(question, take)) {
      result.cpu_ms = 1e3 * std::max(0.0, program_->cpu_s() - cpu_s);
    } else {
      result = failed_trial(cell_.system, trial, program_->failure());
      program_ = started(cell_);  // it is never left alone: trials know nothing of each other
    }
    result.wall_ms = clock.wall_ms();
    return result;
  }

 private:
  Json question_json(std::uint32_t trial, const Rig& told) const {
    return Json{{"trial", trial},
                {"true_cameras", true_rig_},
                {"told_cameras", rig_json::cameras_json(told)}};
  }

  const StudyCell& cell_;
  const Rig& truth_;
  Json true_rig_;
  std::shared_ptr<const ToldRigs> told_;
  std::unique_ptr<AnsweringProgram> program_;
};

}  // namespace

void parse_system_answer(const JsonNode& answer, const SystemSettings& system, TrialResult& trial) {
  const bool answered = has_answered(answer);
  trial.status = answered ? LocalisationStatus::answered : LocalisationStatus::unsure;
  if (answered || answer.has("error")) {
    trial.error = bounded_number(answer.at("error"));
    if (!(trial.error >= 0)) {
      throw Error(answer.at("error").place(), "is negative", "give its size");
    }
  }
  trial.measured.emplace(system.measured_names.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < system.measured_names.size(); ++i) {
    const std::string& name = system.measured_names[i];
    if (answer.has(name) && !answer.at(name).json().is_null()) {
      (*trial.measured)[i] = bounded_number(answer.at(name));
    }
  }
}

SystemKind program_kind() {
  using Type = SystemOption::Type;
  return {.name = "program",
          .noun = "a program",
          .error_name = "error",
          .error_title = "error",
          .unit = "",
          .options = {{.name = "command", .type = Type::command},
                      {.name = "time_limit_s", .usual = "60", .low = 1e-3, .high = 86400},
                      {.name = "measured", .type = Type::names}},
          .sections = {"sources", "calibration", "parameters"},
          .sources = SourcesUsed::calibration,
          .tells_rigs = true,
          .is_program = true,
          .make = [](const SystemSetup& setup) { return std::make_unique<ProgramSystem>(setup); }};
}

}  // namespace vernier::sim::internal
