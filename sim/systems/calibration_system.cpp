// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/systems/calibration_system.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "localise/localiser.h"
#include "sim/experiment.h"
#include "sim/study/system_kind.h"
#include "sim/study/system_under_test.h"
#include "sim/told/fresh_calibrations.h"

namespace vernier::sim::internal {

using localise::LocalisationStatus;

namespace {

class CalibrationSystem : public SystemUnderTest {
 public:
  explicit CalibrationSystem(const SystemSetup& setup)
      : settings_(setup.cell.system),
        calibrations_(setup.calibrations),
        range_m_(settings_.number("range_m")) {}

  TrialResult run(std::uint32_t trial) override {
    const std::shared_ptr<const FreshCalibration> found = calibrations_->of(trial);
    TrialResult result = scored(trial, *found);
    result.cpu_ms = found->cpu_ms;
    result.wall_ms = found->wall_ms;
    return result;
  }

 private:
  TrialResult scored(std::uint32_t trial, const FreshCalibration& found) const {
    if (!found.failure.empty()) return failed_trial(settings_, trial, found.failure);
    const std::optional<MeasuredDepth> depth =
        measured_depth(found, calibrations_->truth(), range_m_);
    if (!depth) {
      return failed_trial(settings_, trial, fmt::format("no depth at {:g} m with it", range_m_));
    }
    const double error_m = depth->m - range_m_, sd_m = std::sqrt(depth->variance_m2);
    TrialResult result;
    result.trial = trial;
    result.status = found.doubt.empty() ? LocalisationStatus::answered : LocalisationStatus::unsure;
    result.error = std::abs(error_m);
    result.limit = settings_.success_error;
    result.measured = {error_m, sd_m, error_m / sd_m};
    result.failure = found.doubt;
    return result;
  }

  const SystemSettings& settings_;
  std::shared_ptr<const FreshCalibrations> calibrations_;
  double range_m_;
};

}  // namespace

SystemKind calibration_kind() {
  return {
      .name = "calibration",
      .noun = "a calibration",
      .error_name = "depth_error_m",
      .error_title = "depth error",
      .unit = "m",
      .success_error = 0.05,
      .options = {{.name = "range_m", .usual = "5", .low = 0.1, .high = 1000}},
      .measured = {{"signed_depth_error_m", "depth error with its sign, m", true},
                   {"stated_depth_sd_m", "its standard deviation as the covariance states it, m"},
                   {"error_over_sd", "error over stated standard deviation; expected RMS: 1",
                    true}},
      .sections = {"calibration"},
      .calibrates = true,
      .version = 2,  // 2: the covariance of many views is shrunk
      .make = [](const SystemSetup& setup) { return std::make_unique<CalibrationSystem>(setup); }};
}

}  // namespace vernier::sim::internal
