// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/check_mrcal.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include "calib/board_state.h"
#include "calib/error.h"
#include "calib/mrcal/mrcal_comparison.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/mrcal_solver.h"
#include "calib/mrcal/uncertainty_comparison.h"
#include "calib/solver/minimise_reprojection.h"
#include "calib/solver/refined_minimum.h"
#include "calib/solver/reprojection_problem.h"
#include "calib/solver/resolve.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"
#include "cli/program/share_folder.h"

namespace vernier::cli {
namespace {

/// Least CPU time of three runs, ms.
template <typename F>
double cpu_ms(const F& run) {
  double least = INFINITY;
  for (int i = 0; i < 3; ++i) {
    const std::clock_t start = std::clock();
    run();
    least = std::min(least, 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return least;
}

/// A problem that mrcal can solve too: without priors and with a fixed board shape.
struct ComparableProblem {
  RefinedMinimum ours;
  ReprojectionProblem problem;
  BoardState start;  ///< with the board warp of our minimum
};

ComparableProblem comparable_problem(const CheckedProblem& p, Session& session) {
  ComparableProblem like;
  like.start = p.start;
  like.start.warp_m = p.state.warp_m;
  like.problem = p.problem;
  like.problem.priors.clear();
  like.problem.warp = BoardWarp::known;
  if (p.problem.priors.empty() && p.problem.warp == BoardWarp::known) {
    const double variance = p.problem.pixel_sigma_px * p.problem.pixel_sigma_px;
    like.ours.state = p.state;
    like.ours.unit_bound = p.bound / variance;
    like.ours.cost_px2 = refine_minimum(p.observations, p.state, p.problem.held).cost_px2;
    return like;
  }
  session.warn("mrcal is compared with a calibration " +
               std::string(p.problem.priors.empty()
                               ? "with the board warp fixed at its estimate"
                               : "without the prior, which mrcal does not support"));
  like.ours = refine_minimum(
      p.observations, minimise_reprojection(p.observations, p.state, like.problem), p.problem.held);
  return like;
}

/// mrcal's solution compared with ours, and the uncertainty from mrcal's Python functions.
struct MrcalAnswers {
  MrcalCheck solved;
  UncertaintyComparison propagated;
  std::string failure;  ///< why mrcal's Python functions failed although installed
};

std::vector<ToleranceCheck> gates_of(const MrcalComparison& solved,
                                     const UncertaintyComparison& propagated) {
  std::vector<ToleranceCheck> gates{
      {"parameters, in standard deviations", "max_parameter_diff_sigma", solved.worst_parameter,
       solved.max_parameter_diff_sigma, parameter_gate_sigma},
      {"covariance, normalised", "max_covariance_diff", solved.worst_covariance,
       solved.max_covariance_diff, covariance_gate}};
  if (!propagated.absent.empty()) return gates;
  gates.push_back({"projection covariance, normalised", "max_projection_covariance_diff",
                   propagated.worst_projection, propagated.max_projection_covariance_diff,
                   projection_covariance_gate});
  if (propagated.triangulations == 0) return gates;
  gates.push_back({"triangulation covariance, normalised", "max_triangulation_covariance_diff",
                   fmt::format("{} points", propagated.triangulations),
                   worse(propagated.max_triangulation_covariance_diff,
                         propagated.max_observation_covariance_diff),
                   projection_covariance_gate});
  return gates;
}

/// Skipped, with the reason, if the script or mrcal's Python module is missing.
MrcalAnswers ask_both(const CheckedProblem& p, const ComparableProblem& like) {
  const RefinedMinimum& ours = like.ours;
  MrcalAnswers answers;
  const double sigma = p.problem.pixel_sigma_px;
  answers.solved = check_against_mrcal(p.observations, like.start, ours, sigma, p.problem.held);
  try {
    answers.propagated = compare_uncertainty(shipped_script("mrcal_uncertainty.py"), p.observations,
                                             ours, sigma, p.problem.held);
  } catch (const Error& error) {
    answers.propagated.absent = answers.failure = error.what();
  }
  return answers;
}

CheckSection part_of(const MrcalAnswers& answers, double vernier_ms, double resolve_ms) {
  const auto& [solved, propagated, failure] = answers;
  CheckSection part;
  part.json["max_projection_covariance_diff"] = nullptr;
  add_gates(fmt::format("against mrcal {}", mrcal_version()), "mrcal's",
            gates_of(solved.comparison, propagated), part);
  if (!failure.empty()) part.failures.push_back("mrcal check failed: " + failure);
  const MrcalSolution& theirs = solved.solution;
  part.json["cost_relative_diff"] = solved.comparison.cost_relative_diff;
  part.json["mrcal_stopped_short_sigma"] = theirs.stopped_short_sigma;
  part.json["mrcal_solve_ms"] = theirs.solve_cpu_ms;
  part.json["mrcal_solve_lens"] = theirs.timed_lens;
  part.json["vernier_solve_ms"] = vernier_ms;
  part.json["vernier_resolve_ms"] = resolve_ms;
  part.json["version"] = mrcal_version();
  if (!propagated.absent.empty()) part.json["projection_reason"] = propagated.absent;
  if (!solved.restarted.empty()) {
    part.json["restarted"] = solved.restarted;
    part.text += "  " + solved.restarted + "; restarted near our minimum\n";
  }
  if (!propagated.absent.empty()) {
    part.text += "  projection and triangulation not compared: " + propagated.absent + "\n";
  }
  part.text += fmt::format(
      "  solve, CPU ms: mrcal {:.1f} ({}), vernier {:.1f}, vernier's re-solver {:.2f}\n",
      theirs.solve_cpu_ms, theirs.timed_lens, vernier_ms, resolve_ms);
  return part;
}

}  // namespace

CheckSection check_by_mrcal(const CheckedProblem& p, Session& session) {
  CheckSection part;
  if (!mrcal_available()) {
    part.reason = "this build has no libmrcal (install Debian's libmrcal-dev and rebuild)";
  } else {
    bool possible = false;
    try {
      const MrcalProblem problem(p.observations, p.start);  // throws where mrcal has no such one
      possible = true;
      const ComparableProblem like = comparable_problem(p, session);
      const MrcalAnswers answers = ask_both(p, like);
      const BoardState& start = like.start;
      const Resolver resolver(p.observations, start, like.problem);
      return part_of(answers,
                     cpu_ms([&] { minimise_reprojection(p.observations, start, like.problem); }),
                     cpu_ms([&] { resolver.resolve(); }));
    } catch (const Error& error) {
      part.reason = error.what();
      if (possible) part.failures.push_back("mrcal check failed: " + part.reason);
    }
  }
  part.text = "mrcal check skipped: " + part.reason + "\n";
  return part;
}

}  // namespace vernier::cli
