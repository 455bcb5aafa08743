// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/check_mrcal.h"

#include <cmath>
#include <ctime>

#include "calib/error.h"
#include "calib/mrcal/mrcal_comparison.h"
#include "calib/mrcal/mrcal_problem.h"
#include "calib/mrcal/uncertainty_comparison.h"
#include "calib/resolve.h"
#include "cli/share_folder.h"

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

/// What mrcal can be compared with: it has no priors, and here the board keeps its shape.
struct LikeWithLike {
  RefinedMinimum ours;
  ReprojectionProblem problem;
};

LikeWithLike like_with_like(const CheckedProblem& p, const Session& session) {
  LikeWithLike like;
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
  session.warn("mrcal is compared with the calibration " +
               std::string(p.problem.priors.empty() ? "with the board's shape held where it is"
                                                    : "without its prior, which mrcal has not"));
  like.ours = refine_minimum(
      p.observations, minimise_reprojection(p.observations, p.state, like.problem), p.problem.held);
  return like;
}

struct Gate {
  std::string what, key, where;
  double value = 0, limit = 0;

  bool holds() const { return value <= limit; }
};

std::vector<Gate> gates_of(const MrcalComparison& solved, const UncertaintyComparison& propagated) {
  std::vector<Gate> gates{
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
                   std::max(propagated.max_triangulation_covariance_diff,
                            propagated.max_observation_covariance_diff),
                   projection_covariance_gate});
  return gates;
}

CheckPart part_of(const MrcalCheck& solved,
                  const UncertaintyComparison& propagated,
                  double vernier_ms,
                  double resolve_ms) {
  CheckPart part;
  part.text = fmt::format("against mrcal {}:\n  {:<38} {:>10} {:>8}\n", mrcal_version(),
                          "largest difference", "found", "gate");
  part.json["max_projection_covariance_diff"] = nullptr;
  for (const Gate& gate : gates_of(solved.comparison, propagated)) {
    part.json[gate.key] = gate.value;
    const std::string verdict = gate.holds() ? "holds" : "FAILS";
    part.text += fmt::format("  {:<38} {:>10.1e} {:>8.0e}  {}  ({})\n", gate.what, gate.value,
                             gate.limit, verdict, gate.where);
    if (gate.holds()) continue;
    part.failures.push_back(fmt::format("{} differ from mrcal's by {:.1e} ({}; gate {:.0e})",
                                        gate.what, gate.value, gate.where, gate.limit));
  }
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
    part.text += "  " + solved.restarted + "; it started again near our minimum\n";
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

CheckPart check_by_mrcal(const CheckedProblem& p, const Session& session) {
  CheckPart part;
  if (!mrcal_available()) {
    part.reason = "this build has no libmrcal (Debian's libmrcal-dev, then build again)";
  } else {
    try {
      const LikeWithLike like = like_with_like(p, session);
      const MrcalCheck solved = check_against_mrcal(p.observations, p.start, like.ours,
                                                    p.problem.pixel_sigma_px, p.problem.held);
      const UncertaintyComparison propagated =
          compare_uncertainty(share_folder() / "python" / "mrcal_uncertainty.py", p.observations,
                              like.ours, p.problem.pixel_sigma_px, p.problem.held);
      const Resolver resolver(p.observations, p.start, like.problem);
      return part_of(solved, propagated,
                     cpu_ms([&] { minimise_reprojection(p.observations, p.start, like.problem); }),
                     cpu_ms([&] { resolver.resolve(); }));
    } catch (const Error& error) {
      part.reason = error.what();
    }
  }
  part.text = "mrcal was left out: " + part.reason + "\n";
  return part;
}

}  // namespace vernier::cli
