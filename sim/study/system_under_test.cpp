// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/study/system_under_test.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/sampler.h"
#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/system_kind.h"
#include "sim/told_rigs.h"

namespace vernier::sim::internal {

std::vector<TrialResult> run_block(SystemUnderTest& system, const TrialBlock& block) {
  std::vector<TrialResult> results;
  results.reserve(block.count);
  for (std::uint32_t i = 0; i < block.count; ++i) results.push_back(system.run(block.first + i));
  return results;
}

std::shared_ptr<const ToldRigs> rigs_told(const SystemSetup& setup) {
  const ExperimentSettings& settings = setup.cell.experiment;
  if (setup.told || settings.sources.calibration == 0) return setup.told;
  return drawn_rigs(RigSampler(setup.rig, "rig"), settings.sources.calibration, settings.seed);
}

TrialResult failed_trial(const SystemSettings& system, std::uint32_t trial, std::string why) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  TrialResult failed;
  failed.trial = trial;
  failed.status = localise::LocalisationStatus::failed;
  failed.error = failed.node_error_m = failed.heading_error_rad = unknown;
  failed.limit = system.success_error;
  failed.measured.emplace(system.measured_names.size(), unknown);
  failed.failure = std::move(why);
  return failed;
}

}  // namespace vernier::sim::internal
