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

/// Solver settings from the command line. Shared by the calibrating verbs.
struct SolverInput {
  std::string model = "radial1";  ///< one, or one per camera separated by commas
  double pixel_sigma_px = 0;
  std::vector<std::string> held;   ///< NAME or NAME=VALUE
  std::vector<std::string> known;  ///< NAME=VALUE,SIGMA
  std::string prior;               ///< a rig file
  bool warp = false, keep_outliers = false;
  bool board_shape = false, motion = false, board_aspect = false, no_effects = false;

  /// Whether the board's shape, motion and aspect are estimated where a test finds them.
  bool looks_for_effects() const { return !board_shape && !motion && !board_aspect && !no_effects; }
};

/// Adds the solver options. `input` must outlive the parsing.
void add_solver_options(CLI::App* verb, SolverInput& input);

/// The names of all these options.
inline constexpr std::array solver_options{
    "--model",         "--pixel-sigma", "--hold",   "--know",         "--prior",     "--warp",
    "--keep-outliers", "--board-shape", "--motion", "--board-aspect", "--no-effects"};

/// Converts to calibration options. Throws Error naming an option that cannot be parsed.
CalibrationOptions calibration_options(const SolverInput& input, Session& session);

/// The prior from a rig file. Throws Error, naming the file `place`, if it has no covariance or one
/// that is not positive semi-definite or is singular.
GaussianRigPrior usable_prior(const RigFile& file, const std::string& place);

}  // namespace vernier::cli
