// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/check_held_out.h"

#include <string>

#include "calib/board_observations.h"
#include "calib/validation/held_out_boards.h"
#include "cli/calibration/check_section.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

std::string coverage_line(const std::string& what,
                          const LengthCoverage& c,
                          double scale,
                          const std::string& unit) {
  return fmt::format(
      "  {:<24} {:>6} {:>9.3f} {:<4} {:>8.1f} % {:>8.1f} % {:>8.1f} % {:>10.2f} {:>7.2f} "
      "{:>7.2f}\n",
      what, c.lengths, scale * c.error_rms_m, unit, 100 * c.coverage_components,
      100 * c.coverage_honest, 100 * c.coverage_mvb, c.z_rms_components, c.z_rms_honest,
      c.z_rms_mvb);
}

/// The number of corners and boards that could not be predicted, if any.
std::string without_a_point(const HeldOutBoardsResult& result) {
  std::string text;
  if (result.corners_left_out > 0) {
    text += fmt::format("{} corners that do not triangulate", result.corners_left_out);
  }
  if (result.boards_left_out > 0) {
    text += fmt::format("{}{} boards of which both cameras see too few corners",
                        text.empty() ? "" : ", ", result.boards_left_out);
  }
  return text.empty() ? text : " (excluded: " + text + ")";
}

}  // namespace

Json coverage_json(const LengthCoverage& c) {
  return {{"lengths", c.lengths},
          {"coverage_honest", c.coverage_honest},
          {"coverage_mvb", c.coverage_mvb},
          {"z_rms_honest", c.z_rms_honest},
          {"z_rms_mvb", c.z_rms_mvb},
          {"error_rms", c.error_rms_m},
          {"sigma_honest", c.sigma_honest_m},
          {"sigma_mvb", c.sigma_mvb_m},
          {"coverage_components", c.coverage_components},
          {"z_rms_components", c.z_rms_components},
          {"sigma_components", c.sigma_components_m}};
}

CheckSection check_held_out_boards(const BoardObservations& observations,
                                   const HeldOutBoardsOptions& options,
                                   const Session& session) {
  Progress progress(session, "splits");
  const HeldOutBoardsResult result = evaluate_held_out_boards(
      observations, options, [&](int done, int total) { progress.update(done, total); });
  CheckSection part;
  part.json = {{"splits", result.splits},
               {"failed", result.failed},
               {"training_frames", result.training_frames},
               {"boards", result.boards},
               {"boards_left_out", result.boards_left_out},
               {"corners_left_out", result.corners_left_out},
               {"noise_not_found", result.noise_not_found},
               {"boards_stand", options.stand == BoardStand::still ? "still" : "hand-held"},
               {"seed", options.seed},
               {"edges", coverage_json(result.edges)},
               {"scale", coverage_json(result.scale)}};
  part.text = fmt::format(
      "held-out boards: {} splits{}, {} training frames, {} boards predicted{}\n"
      "  {:<24} {:>6} {:>14} {:>32} {:>26}\n"
      "  {:<24} {:>6} {:>14} {:>10} {:>10} {:>10} {:>10} {:>7} {:>7}\n",
      result.splits, result.failed > 0 ? fmt::format(" ({} failed)", result.failed) : "",
      result.training_frames, result.boards, without_a_point(result), "", "", "", "inside 95 %",
      "rms z", "", "", "rms error", "components", "honest", "bound", "components", "honest",
      "bound");
  part.text += coverage_line("rows, columns, diagonals", result.edges, 1e3, "mm");
  part.text += coverage_line("board scale", result.scale, 1e6, "ppm");
  if (result.scale.z_rms_components > 2) {
    part.failures.push_back(fmt::format(
        "held-out boards are mispredicted: their scale is off by {:.1f} predicted standard "
        "deviations (rms); try another lens model, or check that all views are alike",
        result.scale.z_rms_components));
  }
  return part;
}

}  // namespace vernier::cli
