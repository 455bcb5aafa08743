// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/calibration_problem.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/solver/initial_rig.h"
#include "cli/calibration/board_input.h"
#include "cli/calibration/check_file.h"
#include "cli/calibration/check_held_out.h"
#include "cli/calibration/check_mrcal.h"
#include "cli/calibration/check_section.h"
#include "cli/calibration/solver_input.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"

namespace vernier::cli {
namespace {

struct CheckArguments {
  std::string rig;
  BoardInput board;
  SolverInput solver;
  MonteCarloResult copies;
  bool no_mrcal = false, holdout = false;
  int splits = 100, training_frames = 0;
};

/// CheckArguments that nothing would come of.
void refuse_idle_options(const CheckArguments& options) {
  const CLI::App& app = *options.board.app;
  if (!options.rig.empty()) {
    const std::string remedy = "leave it out, or give the corners instead of the rig file";
    refuse_options(app, board_options, "the rig file holds the corners", remedy);
    refuse_options(app, solver_options, "the rig file says how it was solved", remedy);
  }
  if (!options.holdout) {
    refuse_options(app, std::array{"--splits", "--training-frames"}, "it is of --holdout",
                   "add --holdout or leave it out");
  }
}

/// Before anything is solved: boards left out need a pair and some frames.
void check_holdout(const CheckArguments& options, const BoardObservations& observations) {
  constexpr int fewest_frames = 6, fewest_to_calibrate = 3;
  if (!options.holdout) return;
  const auto frames = static_cast<int>(frames_of(observations).size());
  if (observations.size_px.size() < 2 || frames < fewest_frames) {
    throw Error("--holdout",
                fmt::format("needs a pair of cameras and at least six frames; here are {} of the "
                            "one and {} of the other",
                            observations.size_px.size(), frames),
                "give more views, or leave it out");
  }
  const int training = options.training_frames;
  if (training != 0 && (training < fewest_to_calibrate || training >= frames)) {
    throw Error("--training-frames", fmt::format("{} of {} frames", training, frames),
                "give at least 3, and fewer than there are");
  }
}

/// A calibration to check: how it was solved, and its answer.
struct Solved {
  CalibrationOptions how;
  RigEstimate estimate;
  std::optional<RigEstimate> stated;  ///< what the rig file says
};

/// The calibration that a rig file's evidence is of, solved again from its corners.
Solved solve_again(const CheckArguments& options, Session& session) {
  const std::filesystem::path path = find_rig(options.rig);
  RigFile file = read_rig(path);
  for (const std::string& warning : file.warnings) {
    const bool doubt = warning.starts_with(stored_warning_prefix(path.string()));
    doubt ? session.add_trust_warning(warning) : session.warn(warning);
  }
  if (!file.estimate.evidence || !file.estimate.calibration) {
    throw Error(options.rig, "it holds no evidence to solve again",
                "calibrate without --no-evidence, or give the corners");
  }
  if (file.estimate.evidence->observations.views.empty()) {
    throw Error(options.rig, "it holds no views of a board, which is what check solves again",
                "give a rig that was calibrated from a board; of pairs, combine the file alone");
  }
  if (file.estimate.evidence->pairs.size() > 0) {
    session.warn(options.rig + ": its matched pairs are left aside, only its boards are checked");
  }
  Solved solved{options_of_file(with_default_names(file.estimate)), {}, std::move(file.estimate)};
  solved.how.check_input = true;
  const BoardObservations& observations = solved.stated->evidence->observations;
  check_holdout(options, observations);
  solved.estimate = calibrate(observations, solved.how);
  return solved;
}

Solved solve(const CheckArguments& options, Session& session) {
  refuse_idle_options(options);
  if (!options.rig.empty()) return solve_again(options, session);
  Solved solved{calibration_options(options.solver, session), {}, {}};
  BoardObservations observations = load(options.board, session);
  check_holdout(options, observations);
  solved.estimate = calibrate(std::move(observations), solved.how);
  for (const std::string& warning : solved.estimate.calibration->trust_warnings)
    session.add_trust_warning(warning);
  return solved;
}

CheckedProblem problem_to_check(const Solved& solved) {
  const RigEstimate& estimate = solved.estimate;
  const CalibrationEvidence& evidence = *estimate.evidence;
  CheckedProblem p;
  p.problem = problem_of(solved.how, estimate.rig);
  p.problem.pixel_sigma_px = estimate.calibration->pixel_sigma_px;
  p.state = {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
  p.start = initial_state(evidence.observations, models_of(estimate.rig));
  p.start.rig = with_held_values(p.start.rig, solved.how.held);
  if (solved.how.warp == BoardWarp::known) p.start.warp_m = evidence.warp_m;
  for (std::size_t i = 0; solved.stated && i < p.state.rig.cameras.size(); ++i) {
    p.state.rig.cameras[i].name = p.start.rig.cameras[i].name = solved.stated->rig.cameras[i].name;
  }
  p.observations = evidence.observations;
  p.bound = *estimate.covariance_mvb;
  return p;
}

void run(const CheckArguments& options, Session& session) {
  const Solved solved = solve(options, session);
  const CheckedProblem problem = problem_to_check(solved);
  Json json{{"model", model_name(problem.state.rig.cameras[0].model)},
            {"cameras", problem.state.rig.cameras.size()},
            {"frames", problem.state.frames.size()},
            {"pixel_sigma_px", problem.problem.pixel_sigma_px}};
  std::string text;
  const auto add = [&](const std::string& name, const CheckSection& part) {
    json[name] = part.json;
    if (!part.reason.empty()) {
      json[name + "_reason"] = part.reason;
      session.warn(part.text.substr(0, part.text.find('\n')));
    } else {
      text += part.text;
    }
    for (const std::string& failure : part.failures) session.add_trust_warning(failure);
  };
  if (solved.stated) add("file", check_file(*solved.stated, solved.estimate));
  if (options.no_mrcal) {
    add("mrcal", {nullptr, "mrcal was left out", "--no-mrcal", {}});
  } else {
    add("mrcal", check_by_mrcal(problem, session));
  }
  add("monte_carlo", check_by_monte_carlo(problem, options.copies));
  if (options.holdout) {
    CalibrationOptions how = solved.how;
    how.reject_outliers = false;  // they are out already
    how.check_input = false;      // and so is what does not fit
    add("holdout", check_held_out_boards(problem.observations,
                                         {.training_frames = options.training_frames,
                                          .splits = options.splits,
                                          .seed = options.copies.seed,
                                          .calibration = how},
                                         session));
  }
  session.result(json, text);
}

}  // namespace

void add_check(CLI::App& app, Session& session) {
  auto o = std::make_shared<CheckArguments>();
  CLI::App* verb =
      add_verb(app, session, "check",
               "check a calibration: the same problem by mrcal, and by solving noisy copies of it",
               "vernier check --observations observations.csv --size 640x480 --trials 200");
  verb->add_option("rig", o->rig, "a rig file with its evidence (or give the corners as below)");
  add_board_options(verb, o->board);
  add_solver_options(verb, o->solver);
  verb->add_option("--trials", o->copies.trials, "noisy copies to solve")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  verb->add_option("--seed", o->copies.seed, "of the copies' noise")
      ->check(not_negative)
      ->capture_default_str();
  verb->add_option("--threads", o->copies.threads, "0: all; results do not depend on it")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--no-mrcal", o->no_mrcal, "leave mrcal out");
  verb->add_flag("--holdout", o->holdout,
                 "also predict lengths on boards left out of the calibration, over many splits");
  verb->add_option("--splits", o->splits, "of --holdout")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  verb->add_option("--training-frames", o->training_frames,
                   "frames a split calibrates on (a little over half)")
      ->check(CLI::NonNegativeNumber);
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
