// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/validation/monte_carlo_check.h"
#include "cli/calibration/check_mrcal.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {

CheckSection check_by_monte_carlo(const CheckedProblem& p, const MonteCarloResult& copies) {
  const MonteCarloCheck check =
      monte_carlo_check(p.observations, p.state, p.problem, p.bound,
                        {.trials = copies.trials, .seed = copies.seed, .threads = copies.threads});
  const auto ends = [](const auto& interval) { return Json::array({interval.low, interval.high}); };
  CheckSection part;
  part.json = {{"trials", check.trials},
               {"failed", check.failed},
               {"nees_mean", check.nees_mean},
               {"nees_expected", check.nees_expected},
               {"nees_interval_95", ends(check.nees_interval_95)},
               {"nees_interval_99", ends(check.nees_interval_99)},
               {"std_ratio_min", check.std_ratio_min},
               {"std_ratio_max", check.std_ratio_max},
               {"std_ratios", check.std_ratios},
               {"eigenvalues", check.eigenvalues},
               {"eigenvalue_band_99", ends(check.eigenvalue_band_99)},
               {"ks_p", check.ks_p},
               {"ks_p_components", check.ks_p_components},
               {"consistent", check.consistent()}};
  part.text = fmt::format(
      "Monte Carlo, {} trials{}:\n"
      "  NEES                                   {:.2f}, expected {:.0f}, 95 % interval of the mean "
      "[{:.2f}, {:.2f}]\n"
      "  sampled / predicted sigma              {:.3f} to {:.3f}\n"
      "  eigenvalues of the whitened samples    {:.3f} to {:.3f}, band [{:.3f}, {:.3f}]\n"
      "  Kolmogorov-Smirnov                     p = {:.2g} (NEES), {:.2g} (components)\n",
      check.trials, check.failed > 0 ? fmt::format(" ({} more failed)", check.failed) : "",
      check.nees_mean, check.nees_expected, check.nees_interval_95.low, check.nees_interval_95.high,
      check.std_ratio_min, check.std_ratio_max, check.eigenvalues[0], check.eigenvalues[1],
      check.eigenvalue_band_99.low, check.eigenvalue_band_99.high, check.ks_p,
      check.ks_p_components);
  if (!check.enough_trials_solved()) {
    part.failures.push_back(
        fmt::format("{} of {} Monte Carlo trials could not be solved: the views barely determine "
                    "the rig, and the remaining trials are not representative; use a model with "
                    "fewer parameters, or more views",
                    check.failed, check.trials + check.failed));
  }
  if (!check.scatter_matches_covariance()) {
    part.failures.push_back(fmt::format(
        "Monte Carlo scatter disagrees with the covariance: {} (a correct covariance fails in up "
        "to 3 % of checks; give more --trials to tell)",
        fmt::join(check.departures(), "; ")));
  }
  return part;
}

}  // namespace vernier::cli
