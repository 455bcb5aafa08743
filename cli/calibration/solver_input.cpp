// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/solver_input.h"

#include <CLI/CLI.hpp>
#include <cstddef>
#include <sstream>

#include "calib/base/shown_text.h"
#include "calib/base/text_lines.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/camera.h"
#include "calib/error.h"
#include "calib/rig_file.h"
#include "calib/rig_prior.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

double number(const std::string& text, const std::string& option) {
  if (const auto value = to_finite(text)) return *value;
  throw Error(option, in_quotes(text) + " is not a finite number", "use the form left.ax=1");
}

/// Parses "left.ax=1" or "left.ax".
HeldParameter held_parameter(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return {text, {}};
  return {text.substr(0, equals), number(text.substr(equals + 1), "--hold " + text)};
}

/// Parses "left.f_px=525,3".
ParameterPrior known_parameter(const std::string& text) {
  const std::size_t equals = text.find('='), comma = text.find(',');
  const std::string option = "--know " + text;
  if (equals == std::string::npos || comma == std::string::npos || comma < equals) {
    throw Error(option, "is not NAME=VALUE,SIGMA", "use the form left.f_px=525,3");
  }
  return {text.substr(0, equals), number(text.substr(equals + 1, comma - equals - 1), option),
          number(text.substr(comma + 1), option)};
}

std::vector<CameraModel> models_named(const std::string& text) {
  std::vector<CameraModel> models;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) models.push_back(camera_model(name));
  if (text.empty() || text.back() == ',') models.push_back(camera_model(""));
  return models;
}

}  // namespace

void add_solver_options(CLI::App* verb, SolverInput& input) {
  verb->add_option("--model", input.model,
                   "lens model: pinhole, radial1, opencv4, opencv5, opencv8 or fisheye4; one for "
                   "all cameras, or one per camera separated by commas")
      ->capture_default_str();
  verb->add_option("--pixel-sigma", input.pixel_sigma_px,
                   "noise of a pixel coordinate (default: estimated from the residuals)")
      ->check(finite_and_positive);
  verb->add_option("--hold", input.held,
                   "fix a parameter: NAME at its initial value, or NAME=VALUE (repeatable)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--know", input.known,
                   "Gaussian prior of a parameter: NAME=VALUE,SIGMA (repeatable)")
      ->expected(1)
      ->delimiter('\0')
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--prior", input.prior,
                   "rig file whose parameters and covariance are used as a prior");
  verb->add_flag("--warp", input.warp, "also estimate the board warp");
  verb->add_flag("--keep-outliers", input.keep_outliers, "do not reject outlier corners");
  CLI::Option* shape =
      verb->add_flag("--board-shape", input.board_shape,
                     "estimate the uneven shape of the board, a displacement of each corner "
                     "(default: where a test finds it)");
  CLI::Option* motion =
      verb->add_flag("--motion", input.motion,
                     "let the board move between the exposures of the cameras, as a hand-held one "
                     "does (default: where a test finds it)");
  CLI::Option* aspect =
      verb->add_flag("--board-aspect", input.board_aspect,
                     "estimate the ratio of the board's spacings along x and y, as a printer "
                     "stretches it; turn the board by 90 degrees in some views (default: where a "
                     "test finds it)");
  verb->add_flag("--no-effects", input.no_effects,
                 "leave the board's shape, motion and aspect out, and do not look for them")
      ->excludes(shape)
      ->excludes(motion)
      ->excludes(aspect);
}

GaussianRigPrior usable_prior(const RigFile& file, const std::string& place) {
  GaussianRigPrior known = gaussian_rig_prior(file, place);
  try {
    rig_prior(known.rig, known);
  } catch (const Error& error) {
    throw Error(place, error.place() + ": " + error.fault(), error.remedy());
  }
  return known;
}

CalibrationOptions calibration_options(const SolverInput& input, Session& session) {
  CalibrationOptions options;
  const std::vector<CameraModel> models = models_named(input.model);
  options.model = models.front();
  if (models.size() > 1) options.models = models;
  options.pixel_sigma_px = input.pixel_sigma_px;
  for (const std::string& text : input.held) options.held.push_back(held_parameter(text));
  for (const std::string& text : input.known) options.known.push_back(known_parameter(text));
  if (!input.prior.empty()) {
    const RigFile file = read_rig(input.prior);
    for (const std::string& warning : file.warnings) session.warn(warning);
    options.prior = usable_prior(file, input.prior);
  }
  if (input.warp) options.warp = BoardWarp::free;
  options.reject_outliers = !input.keep_outliers;
  options.board_shape = input.board_shape;
  options.motion = input.motion;
  options.board_aspect = input.board_aspect;
  return options;
}

}  // namespace vernier::cli
