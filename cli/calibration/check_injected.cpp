// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/check_injected.h"

#include "calib/board_observations.h"
#include "calib/board_state.h"
#include "calib/interval.h"
#include "calib/rig_estimate.h"
#include "calib/validation/injected_error.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

Json pair(const Interval& interval) {
  return {json_number(interval.low), json_number(interval.high)};
}

Json level_json(const InjectedErrorLevel& level) {
  return {{"psi_c", level.psi_c},
          {"draws", level.draws},
          {"failed", level.failed},
          {"median_real", json_number(level.median_real)},
          {"median_simulated", json_number(level.median_simulated)},
          {"ratio", json_number(level.ratio())},
          {"ratio_95", pair(level.ratio_95)},
          {"slope", json_number(level.slope)},
          {"slope_95", pair(level.slope_95)},
          {"correlation", json_number(level.correlation)}};
}

std::string level_line(const InjectedErrorLevel& level) {
  if (level.draws == 0) {
    return fmt::format("  {:>7g}  no draw is a rig that sees these boards\n", level.psi_c);
  }
  return fmt::format(
      "  {:>7g} {:>9.4f} % {:>9.4f} % {:>6.2f} ({:.2f} to {:.2f}) {:>8.3f} {:>8.3f}{}\n",
      level.psi_c, 100 * level.median_real, 100 * level.median_simulated, level.ratio(),
      level.ratio_95.low, level.ratio_95.high, level.slope, level.correlation,
      level.failed > 0 ? fmt::format("  {} failed", level.failed) : "");
}

}  // namespace

CheckSection check_injected(const RigEstimate& estimate,
                            const BoardObservations& observations,
                            const BoardState& state,
                            double pixel_sigma_px,
                            const InjectedErrorOptions& options,
                            const Session& session) {
  Progress progress(session, "factors");
  const InjectedErrorResult result =
      inject_calibration_error(estimate, observations, state, pixel_sigma_px, options,
                               [&](int done, int total) { progress.update(done, total); });
  CheckSection part;
  part.json = {{"boards", result.boards},
               {"seed", options.seed},
               {"median_real", result.median_real},
               {"median_simulated", result.median_simulated},
               {"levels", Json::array()}};
  part.text = fmt::format(
      "injected error: lengths on {} boards by wrong rigs, {} draws of each factor; median error\n"
      "  {:>7} {:>11} {:>11} {:>23} {:>8} {:>8}\n"
      "  {:>7} {:>9.4f} % {:>9.4f} % {:>6.2f}\n",
      result.boards, options.draws, "psi_c", "real", "simulated", "real / simulated   ", "slope",
      "correl.", "none", 100 * result.median_real, 100 * result.median_simulated,
      result.median_real / result.median_simulated);
  for (const InjectedErrorLevel& level : result.levels) {
    part.json["levels"].push_back(level_json(level));
    part.text += level_line(level);
    if (2 * level.failed > options.draws) {
      part.failures.push_back(fmt::format(
          "at psi_c {:g} {} of {} draws are no rigs that see these boards: inject smaller errors",
          level.psi_c, level.failed, options.draws));
    }
  }
  return part;
}

}  // namespace vernier::cli
