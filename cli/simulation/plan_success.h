// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "calib/planning/views_needed.h"
#include "cli/program/session.h"
#include "cli/simulation/plan_result.h"
#include "sim/experiment.h"
#include "sim/study/study.h"

namespace vernier::cli {

/// The trials whose success a plan aims at: those of a study file, or of a localiser.
struct SuccessTrials {
  std::string study;  ///< file; empty: the localiser that follows
  std::string world = "workshop", protocol = "path", method = "lines";
  double within_m = success_radius_m;
  int trials = 300, threads = 0;  ///< at each scale of the calibration's error
};

void add_success_options(CLI::App& verb, SuccessTrials& trials);

/// The study of these trials, of one cell, which the rig that is planned for is to enter. Throws
/// Error at the line of a study that sweeps, that tells rigs itself or on whose system no
/// calibration acts. `app` tells which options were given.
Study study_of(const SuccessTrials& trials,
               std::uint64_t seed,
               const CLI::App& app,
               Session& session);

/// Success against the calibration's error, and from it the depth error that is allowed.
void allow_for_success(Study study, int threads, PlanResult& plan, Session& session);

/// The views that a success rate takes: how well the trials know the scale that it allows is drawn
/// with the views. Without an upper end if they leave open whether it can be reached, or whether
/// within so many views.
ViewsNeeded views_for_success(const PlanResult& plan,
                              const ViewKnowledge& known,
                              ViewPlanOptions how);

}  // namespace vernier::cli
