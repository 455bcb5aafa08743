// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibration/calibration_problem.h"

#include <fmt/format.h>

#include <cmath>

#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/rig.h"
#include "calib/rig_prior.h"
#include "calib/solver/reprojection_problem.h"

namespace vernier::internal {

void check_numbers(const CalibrationOptions& options) {
  if (!(options.pixel_sigma_px >= 0) || !std::isfinite(options.pixel_sigma_px)) {
    throw Error("calibration", fmt::format("pixel noise of {} px", options.pixel_sigma_px),
                "give a number above 0, or 0 to estimate it");
  }
  if (options.max_iterations < 1) {
    throw Error("calibration", fmt::format("{} iterations", options.max_iterations),
                "give 1 or more");
  }
}

namespace {

void refuse_held_and_known(const CalibrationOptions& options) {
  for (const HeldParameter& held : options.held) {
    for (const ParameterPrior& known : options.known) {
      if (known.name != held.name) continue;
      throw Error("held parameter " + held.name, "is also given a value with a standard deviation",
                  "hold it (--hold), or say how well it is known (--know)");
    }
  }
}

}  // namespace

ReprojectionProblem problem_of(const CalibrationOptions& options, const Rig& rig) {
  ReprojectionProblem problem;
  if (options.pixel_sigma_px > 0) problem.pixel_sigma_px = options.pixel_sigma_px;
  problem.held = held_mask(rig, options.held);
  refuse_held_and_known(options);
  problem.warp = options.warp;
  problem.max_iterations = options.max_iterations;
  if (options.prior) problem.priors.push_back(rig_prior(rig, *options.prior));
  if (!options.known.empty()) problem.priors.push_back(rig_prior(rig, options.known));
  return problem;
}

}  // namespace vernier::internal
