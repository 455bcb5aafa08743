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
#include <vector>

#include "calib/base/error_place.h"
#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/calibrate.h"
#include "calib/calibration/calibration_problem.h"
#include "calib/calibration/solve_again.h"
#include "calib/camera.h"
#include "calib/camera/model_nesting.h"
#include "calib/error.h"
#include "calib/estimate/held_parameters.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/solver/initial_rig.h"
#include "calib/validation/held_out_boards.h"
#include "calib/validation/monte_carlo_check.h"
#include "cli/calibration/board_input.h"
#include "cli/calibration/check_file.h"
#include "cli/calibration/check_halves.h"
#include "cli/calibration/check_held_out.h"
#include "cli/calibration/check_injected.h"
#include "cli/calibration/check_mrcal.h"
#include "cli/calibration/check_noise.h"
#include "cli/calibration/check_section.h"
#include "cli/calibration/found_effects.h"
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
  bool no_mrcal = false, holdout = false, halves = false;
  int splits = 100, training_frames = 0;
  std::vector<double> injected;  ///< factors of --inject
  std::string stand = "hand-held";
};

/// Throws Error for options that would have no effect.
void refuse_unused_options(const CheckArguments& options) {
  const CLI::App& app = *options.board.app;
  if (!options.rig.empty()) {
    const std::string remedy = "leave it out, or give the corners instead of the rig file";
    refuse_options(app, board_options, "the rig file contains the corners", remedy);
    refuse_options(app, solver_options, "the rig file contains the solver settings", remedy);
  }
  if (!options.holdout) {
    refuse_options(app, std::array{"--training-frames", "--boards"}, "only valid with --holdout",
                   "add --holdout or leave it out");
  }
  if (!options.holdout && !options.halves) {
    refuse_options(app, std::array{"--splits"}, "only valid with --holdout or --halves",
                   "add one of them or leave it out");
  }
}

/// Checked before solving: held-out boards need a pair of cameras, and splits some frames.
void check_splits(const CheckArguments& options, const BoardObservations& observations) {
  constexpr int fewest_to_calibrate = 3;
  const auto frames = static_cast<int>(frames_of(observations).size());
  if (options.halves && frames < fewest_frames_to_divide) {
    throw Error("--halves", fmt::format("needs at least six frames; got {}", frames),
                "give more views, or leave it out");
  }
  if (!options.injected.empty() && observations.size_px.size() < 2) {
    throw Error("--inject", "needs two cameras; got one", "give views of a pair, or leave it out");
  }
  if (!options.holdout) return;
  if (observations.size_px.size() < 2 || frames < fewest_frames_to_divide) {
    throw Error(
        "--holdout",
        fmt::format("needs two cameras and at least six frames; got {} camera(s) and {} frame(s)",
                    observations.size_px.size(), frames),
        "give more views, or leave it out");
  }
  const int training = options.training_frames;
  if (training != 0 && (training < fewest_to_calibrate || training >= frames)) {
    throw Error("--training-frames", fmt::format("{} of {} frames", training, frames),
                "give at least 3 and fewer than the number of frames");
  }
}

/// Halves that share a prior cannot show how far they are apart.
void refuse_prior(const CheckArguments& options, const CalibrationOptions& how) {
  if (options.halves && (how.prior || !how.known.empty())) {
    throw Error("--halves", "both halves would share the prior, which hides how far they are apart",
                "check a calibration without a prior");
  }
}

/// A calibration to check: solver options and solution.
struct Solved {
  CalibrationOptions how;
  RigEstimate estimate;
  std::optional<RigEstimate> from_file;  ///< the estimate stored in the rig file
};

/// Said where only two of the cameras of a rig are compared.
void tell_of_first_pair(const CheckArguments& options, const Solved& solved, Session& session) {
  const std::vector<Camera>& cameras = solved.estimate.rig.cameras;
  if (cameras.size() < 3 || (!options.holdout && options.injected.empty())) return;
  session.warn(
      fmt::format("lengths on the boards are measured by the first two of {} cameras, {} "
                  "and {}",
                  cameras.size(), cameras[0].name, cameras[1].name));
}

/// Solves the calibration of a rig file again from the stored corners.
Solved solve_again(const CheckArguments& options, Session& session) {
  const std::filesystem::path path = find_rig(options.rig);
  RigFile file = read_rig(path);
  for (const std::string& warning : file.warnings) {
    const bool stored_warning = warning.starts_with(stored_warning_prefix(path.string()));
    stored_warning ? session.add_trust_warning(warning) : session.warn(warning);
  }
  if (!file.estimate.evidence || !file.estimate.calibration) {
    throw Error(options.rig, "the file has no stored evidence to solve again",
                "calibrate without --no-evidence, or give the corners");
  }
  if (file.estimate.evidence->observations.views.empty()) {
    throw Error(
        options.rig, "the file has no views of a board, which check solves again",
        "give a rig calibrated from a board; for pairs, run vernier combine with this file alone");
  }
  if (file.estimate.evidence->pairs.size() > 0) {
    session.warn(options.rig + ": matched pairs are ignored; only the board views are checked");
  }
  Solved solved{
      options_to_solve_again(with_default_names(file.estimate)), {}, std::move(file.estimate)};
  solved.how.check_input = true;
  refuse_prior(options, solved.how);
  const BoardObservations& observations = solved.from_file->evidence->observations;
  check_splits(options, observations);
  solved.estimate =
      with_errors_of(options.rig, [&] { return calibrate(observations, solved.how); });
  return solved;
}

Solved solve(const CheckArguments& options, Session& session) {
  refuse_unused_options(options);
  if (!options.rig.empty()) return solve_again(options, session);
  Solved solved{calibration_options(options.solver, session), {}, {}};
  refuse_prior(options, solved.how);
  const BoardObservations observations = load(options.board, session);
  check_splits(options, observations);
  const bool look = options.solver.looks_for_effects();
  solved.estimate =
      calibrate_and_look(observations, solved.how, {.effects = look, .models = look}).estimate;
  for (const std::string& warning : solved.estimate.calibration->trust_warnings)
    session.add_trust_warning(warning);
  return solved;
}

/// Said where a check knows no random effects.
void tell_of_effects(const CheckArguments& options, const Solved& solved, Session& session) {
  if (solved.how.board_aspect) {
    session.warn("the board's aspect is estimated; all but the halves take it as known");
  }
  if (!solved.how.board_shape && !solved.how.motion) return;
  std::string checks = "mrcal and Monte Carlo";
  if (!options.injected.empty()) checks += ", the rigs that are wrong on purpose";
  if (options.holdout) checks += ", the held-out boards";
  session.warn(
      "the board's shape and motion are estimated; checked without, from the same corners: " +
      checks);
}

BoardState state_of(const RigEstimate& estimate) {
  const CalibrationEvidence& evidence = *estimate.evidence;
  return {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
}

/// Of the usual calibration.
CheckedProblem problem_to_check(const Solved& solved, const RigEstimate& estimate) {
  const CalibrationEvidence& evidence = *estimate.evidence;
  CheckedProblem p;
  p.problem = problem_of(solved.how, estimate.rig);
  p.problem.pixel_sigma_px = estimate.calibration->pixel_sigma_px;
  p.state = state_of(estimate);
  p.start = initial_state(evidence.observations, models_of(estimate.rig));
  p.start.rig = with_held_values(p.start.rig, solved.how.held);
  if (solved.how.warp == BoardWarp::known) p.start.warp_m = evidence.warp_m;
  for (std::size_t i = 0; solved.from_file && i < p.state.rig.cameras.size(); ++i) {
    p.state.rig.cameras[i].name = p.start.rig.cameras[i].name =
        solved.from_file->rig.cameras[i].name;
  }
  p.observations = evidence.observations;
  p.bound = *estimate.covariance_mvb;
  return p;
}

void run(const CheckArguments& options, Session& session) {
  const Solved solved = solve(options, session);
  tell_of_first_pair(options, solved, session);
  const RigEstimate usual = without_effects(solved.estimate);
  tell_of_effects(options, solved, session);
  const CheckedProblem problem = problem_to_check(solved, usual);
  require_enough_trials(problem.bound, options.copies.trials);
  Json json{{"model", model_name(problem.state.rig.cameras[0].model)},
            {"cameras", problem.state.rig.cameras.size()},
            {"frames", problem.state.frames.size()},
            {"pixel_sigma_px", problem.problem.pixel_sigma_px}};
  std::string text;
  const auto add = [&](const std::string& name, const CheckSection& part) {
    json[name] = part.json;
    if (!part.reason.empty()) {
      json[name + "_reason"] = part.reason;
      const bool is_asked_for = part.reason.starts_with("--");
      if (!is_asked_for) session.warn(part.text.substr(0, part.text.find('\n')));
    } else {
      text += part.text;
    }
    for (const std::string& failure : part.failures) session.add_trust_warning(failure);
  };
  if (solved.from_file) add("file", check_file(*solved.from_file, solved.estimate));
  add("mrcal", options.no_mrcal ? CheckSection{nullptr, "mrcal check skipped", "--no-mrcal", {}}
                                : check_by_mrcal(problem, session));
  add("monte_carlo", check_by_monte_carlo(problem, options.copies));
  CalibrationOptions how = solved.how;
  how.reject_outliers = false;  // already removed
  how.check_input = false;      // already checked
  if (options.halves) {
    add("halves", check_halves(problem.observations,
                               {.splits = options.splits,
                                .seed = options.copies.seed,
                                .threads = options.copies.threads,
                                .calibration = how},
                               session));
  }
  if (!options.injected.empty()) {
    add("injected",
        check_injected(usual, problem.observations, problem.state, problem.problem.pixel_sigma_px,
                       {.psi_c = options.injected,
                        .draws = options.copies.trials,
                        .seed = options.copies.seed,
                        .threads = options.copies.threads},
                       session));
  }
  if (options.holdout) {
    const BoardStand stand = options.stand == "still" ? BoardStand::still : BoardStand::hand_held;
    how.board_shape = how.motion = how.board_aspect = false;
    add("noise", check_corner_noise(usual, stand, session));
    add("holdout", check_held_out_boards(problem.observations,
                                         {.training_frames = options.training_frames,
                                          .splits = options.splits,
                                          .seed = options.copies.seed,
                                          .calibration = how,
                                          .stand = stand},
                                         session));
  }
  session.result(json, text);
}

}  // namespace

void add_check(CLI::App& app, Session& session) {
  auto o = std::make_shared<CheckArguments>();
  CLI::App* verb = add_verb(
      app, session, "check",
      "check a calibration: solve the same problem with mrcal, and by Monte Carlo simulation",
      "vernier check --observations observations.csv --size 640x480 --trials 200");
  verb->add_option("rig", o->rig,
                   "rig file with stored evidence (or give corners with the options below)");
  add_board_options(verb, o->board);
  add_solver_options(verb, o->solver);
  verb->add_option("--trials", o->copies.trials,
                   "number of Monte Carlo trials, and of wrong rigs of --inject")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  verb->add_option("--seed", o->copies.seed, "random seed of the Monte Carlo noise")
      ->capture_default_str();
  verb->add_option("--threads", o->copies.threads,
                   "number of threads (0: all); does not affect results")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--no-mrcal", o->no_mrcal, "skip the comparison with mrcal");
  verb->add_flag("--holdout", o->holdout,
                 "cross-validate: measure lengths on held-out boards, over random splits");
  verb->add_flag("--halves", o->halves,
                 "calibrate random halves of the views, and test whether they differ as their "
                 "covariances state");
  verb->add_option("--inject", o->injected,
                   "tell rigs that are wrong by draws of the covariance times these factors, as "
                   "1,3,10,30, and compare lengths on the real boards with simulated ones")
      ->delimiter(',')
      ->check(CLI::Range(1e-3, 1e4));
  verb->add_option("--splits", o->splits, "number of splits for --holdout and --halves")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  verb->add_option("--training-frames", o->training_frames,
                   "training frames per split (default: slightly more than half)")
      ->check(CLI::NonNegativeNumber);
  verb->add_option(
          "--boards", o->stand,
          "hand-held: the boards of --holdout may move between the exposures of the cameras; "
          "still: they stand, or the cameras are synchronised")
      ->check(CLI::IsMember({"hand-held", "still"}))
      ->capture_default_str();
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
