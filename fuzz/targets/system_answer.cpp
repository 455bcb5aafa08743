// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"
#include "fuzz/program_answer.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/system_kind.h"
#include "sim/systems/program_system.h"

namespace vernier::fuzz {
namespace {

using namespace vernier::sim;
using namespace vernier::sim::internal;

void run_system_answer(std::string_view bytes) {
  SystemSettings system;
  system.name = "program";
  system.measured_names = {"drift_m", "steps"};
  TrialResult trial;
  trial.error = std::nan("");
  const auto taken = accepted_answer(
      bytes, [&](const auto& said) { return (parse_system_answer(said, system, trial), 0); });
  if (!taken) return;
  require(trial.measured && trial.measured->size() == 2, "every quantity has its place");
  require(trial.answered() == (trial.status == localise::LocalisationStatus::answered) &&
              (trial.answered() ? trial.error >= 0 && std::isfinite(trial.error)
                                : std::isnan(trial.error) || trial.error >= 0),
          "an answer has an error");
  for (const double value : *trial.measured) {
    require(std::isnan(value) || std::isfinite(value), "quantities are finite or unknown");
  }
}

std::vector<std::string> system_answer_seeds() {
  return {R"({"error":0.25,"drift_m":-1e-3,"steps":12})", R"({"answered":false})",
          R"({"answered":false,"error":2.5,"steps":null})"};
}

const Registered registered_system_answer{
    {"system_answer", 1000, "views", run_system_answer, system_answer_seeds}};

}  // namespace
}  // namespace vernier::fuzz
