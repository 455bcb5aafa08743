// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "calib/rig_file.h"
#include "calib/rig_prior.h"
#include "cli/program/cli11_fwd.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// What the command line says of how to solve. The verbs that calibrate share it.
struct SolverInput {
  std::string model = "radial1";  ///< one, or one a camera with commas between
  double pixel_sigma_px = 0;
  std::vector<std::string> held;   ///< NAME or NAME=VALUE
  std::vector<std::string> known;  ///< NAME=VALUE,SIGMA
  std::string prior;               ///< a rig file
  bool warp = false, keep_outliers = false;
};

/// `input` must outlive the parsing.
void add_solver_options(CLI::App* verb, SolverInput& input);

/// The names of all these.
inline constexpr std::array solver_options{"--model", "--pixel-sigma", "--hold",         "--know",
                                           "--prior", "--warp",        "--keep-outliers"};

/// Throws Error naming the option that cannot be read.
CalibrationOptions calibration_options(const SolverInput& input, Session& session);

/// What a rig file says as a prior. Throws Error, naming the file at `place`, where it can be none:
/// no covariance, or one that is not positive semi-definite or is singular.
GaussianRigPrior usable_prior(const RigFile& file, const std::string& place);

}  // namespace vernier::cli
