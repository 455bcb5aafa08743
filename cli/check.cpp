// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibrate.h"
#include "calib/error.h"
#include "calib/model_nesting.h"
#include "calib/rig_file.h"
#include "cli/board_input.h"
#include "cli/check_left_out.h"
#include "cli/check_mrcal.h"
#include "cli/session.h"
#include "cli/share_folder.h"
#include "cli/solver_input.h"

namespace vernier::cli {
namespace {

struct Options {
  std::string rig;
  BoardInput board;
  SolverInput solver;
  NoisyCopies copies;
  bool no_mrcal = false, holdout = false;
  int splits = 100, training_frames = 0;
};

/// The calibration that a rig file's evidence is of, solved again from its corners.
RigEstimate solve_again(const Options& options, CalibrationOptions& how, Session& session) {
  RigFile file = read_rig(find_rig(options.rig));
  for (const std::string& warning : file.warnings) session.warn(warning);
  const RigEstimate& estimate = file.estimate;
  if (!estimate.evidence || !estimate.calibration) {
    throw Error(options.rig, "it holds no evidence to solve again",
                "calibrate without --no-evidence, or give the corners");
  }
  how.models = models_of(estimate.rig);
  how.pixel_sigma_px = estimate.calibration->pixel_sigma_px;
  how.reject_outliers = false;  // they are not in the evidence
  const std::vector<std::string> names = parameter_names(estimate.rig);
  const Eigen::VectorXd values = parameters(estimate.rig);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& held = estimate.calibration->held;
    if (std::find(held.begin(), held.end(), names[i]) == held.end()) continue;
    how.held.push_back({names[i], values[static_cast<Eigen::Index>(i)]});
  }
  if (!estimate.evidence->warp_m.isZero(0)) how.warp = BoardWarp::free;
  if (estimate.calibration->prior_dof > 0) {
    session.warn("the calibration had a prior, which its file does not hold: checked without it");
  }
  return calibrate(estimate.evidence->observations, how);
}

CheckedProblem checked_problem(const Options& options, CalibrationOptions& how, Session& session) {
  RigEstimate estimate;
  if (!options.rig.empty()) {
    estimate = solve_again(options, how, session);
  } else {
    how = calibration_options(options.solver, session);
    estimate = calibrate(load(options.board, session), how);
  }
  const CalibrationEvidence& evidence = *estimate.evidence;
  CheckedProblem p;
  p.problem = problem_of(how, estimate.rig);
  p.problem.pixel_sigma_px = estimate.calibration->pixel_sigma_px;
  p.state = {estimate.rig, evidence.frames, evidence.T_first_board, evidence.warp_m};
  p.start = initial_state(evidence.observations, models_of(estimate.rig));
  p.start.rig = with_held_values(p.start.rig, how.held);
  if (how.warp == BoardWarp::known) p.start.warp_m = evidence.warp_m;
  p.observations = evidence.observations;
  p.bound = *estimate.covariance_mvb;
  return p;
}

void run(const Options& options, Session& session) {
  CalibrationOptions how;
  const CheckedProblem problem = checked_problem(options, how, session);
  Json json{{"model", model_name(problem.state.rig.cameras[0].model)},
            {"cameras", problem.state.rig.cameras.size()},
            {"frames", problem.state.frames.size()},
            {"pixel_sigma_px", problem.problem.pixel_sigma_px}};
  std::string text;
  const auto add = [&](const std::string& name, const CheckPart& part) {
    json[name] = part.json;
    if (!part.reason.empty()) {
      json[name + "_reason"] = part.reason;
      session.warn(part.text.substr(0, part.text.find('\n')));
    } else {
      text += part.text;
    }
    for (const std::string& failure : part.failures) session.doubt(failure);
  };
  if (options.no_mrcal) {
    add("mrcal", {nullptr, "mrcal was left out", "--no-mrcal", {}});
  } else {
    add("mrcal", check_by_mrcal(problem, session));
  }
  add("monte_carlo", check_by_noisy_copies(problem, options.copies));
  if (options.holdout) {
    how.reject_outliers = false;  // they are out already
    how.check_input = false;      // and so is what does not fit
    add("holdout", check_boards_left_out(problem.observations,
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
  auto o = std::make_shared<Options>();
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
  verb->add_option("--seed", o->copies.seed, "of the copies' noise")->capture_default_str();
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
