// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/calibration/solver_input.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// `vernier calibrate --pairs`: calibrates from matched corners of an arbitrary scene and a prior.
void calibrate_pairs(const std::string& pairs_file,
                     const SolverInput& solver,
                     const std::string& output,
                     bool keep_evidence,
                     Session& session);

}  // namespace vernier::cli
