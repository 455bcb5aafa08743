// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibrate.h"
#include "calib/calibration/solve_again.h"
#include "calib/error.h"
#include "calib/rig_estimate.h"
#include "calib/statistics/distributions.h"
#include "calib/validation/held_out_boards.h"
#include "calib/validation/model_comparison.h"
#include "calib/validation/split_halves.h"
#include "cli/calibration/check_halves.h"
#include "cli/calibration/check_held_out.h"
#include "cli/program/session.h"
#include "cli/report/report_calibration.h"

namespace vernier::cli {
namespace {

constexpr int max_frames = 60;  // if there are more, an evenly spaced subset is used
constexpr int splits = 30;

Json models_json(const ModelComparison& comparison) {
  Json rows = Json::array();
  const auto add = [&](const ModelScore& s, bool in_use) {
    rows.push_back({{"model", s.name},
                    {"in_use", in_use},
                    {"held_out_rms_px", s.held_out_rms_px},
                    {"fitted_rms_px", s.fitted_rms_px},
                    {"better_views", in_use ? Json(nullptr) : Json(s.better_views)},
                    {"gain_sigmas", in_use ? Json(nullptr) : Json(s.gain_sigmas)},
                    {"largest_move", s.largest_move},
                    {"largest_move_sigmas", s.largest_move_sigmas}});
  };
  add(comparison.in_use, true);
  for (const ModelScore& s : comparison.richer) add(s, false);
  return {{"frames", comparison.frames}, {"rows", rows}};
}

void add_models(const RigEstimate& estimate, const CalibrationOptions& options, Json& json) {
  const ModelComparison comparison = compare_models(estimate, options, max_frames);
  if (!comparison.not_compared.empty()) {
    json["notes"].push_back("Lens models were not compared: " + comparison.not_compared + ".");
    return;
  }
  if (!comparison.left_out.empty()) {
    json["notes"].push_back("A lens model was not compared: " + comparison.left_out + ".");
  }
  json["models"] = models_json(comparison);
  for (const std::string& warning : comparison.warnings) json["warnings"].push_back(warning);
}

Json named_coverage(const std::string& what, const std::string& unit, const LengthCoverage& c) {
  Json json{{"what", what}, {"unit", unit}};
  json.update(coverage_json(c));
  return json;
}

void add_left_out(const BoardObservations& observations,
                  const CalibrationOptions& options,
                  const std::string& file,
                  const Session& session,
                  Json& json) {
  session.info(fmt::format("{}: calibrating {} times with held-out boards", file, splits));
  const HeldOutBoardsResult result =
      evaluate_held_out_boards(observations, {.splits = splits, .calibration = options});
  const auto frames = static_cast<int>(frames_of(observations).size());
  json["left_out"] = {{"splits", result.splits},
                      {"failed", result.failed},
                      {"boards", result.boards},
                      {"boards_left_out", result.boards_left_out},
                      {"corners_left_out", result.corners_left_out},
                      {"frames", frames},
                      {"training_frames", result.training_frames},
                      {"rows",
                       {named_coverage("lengths on the board", "m", result.edges),
                        named_coverage("scale of the board", "1", result.scale)}}};
  // Splits share boards: with a dozen boards, 0.8 is about 2.5 standard deviations below 0.95.
  for (const Json& row : json["left_out"]["rows"]) {
    if (row["coverage_components"] >= 0.8) continue;
    json["warnings"].push_back(fmt::format(
        "{} held-out boards: only {:.0f} % are inside their 95 % interval; the lens model, the "
        "board shape or the square size is wrong, or there are too few views",
        row["what"] == "scale of the board" ? "scale of" : "lengths on",
        100 * row["coverage_components"].get<double>()));
  }
}

/// Distances in ascending order beside the quantiles that they should be.
Json distances_json(const SplitHalvesResult& result) {
  std::vector<double> honest, mvb, expected;
  for (const HalvesDistance& d : result.distances) {
    honest.push_back(d.honest);
    mvb.push_back(d.mvb);
    const auto rank = static_cast<double>(expected.size()) + 0.5;
    expected.push_back(chi_squared_quantile(rank / result.splits, result.dof));
  }
  std::sort(honest.begin(), honest.end());
  std::sort(mvb.begin(), mvb.end());
  return {{"honest", honest}, {"mvb", mvb}, {"expected", expected}};
}

void add_halves(const BoardObservations& observations,
                const CalibrationOptions& options,
                const std::string& file,
                const Session& session,
                Json& json) {
  session.info(fmt::format("{}: calibrating halves of the views {} times", file, splits));
  const SplitHalvesResult result =
      compare_split_halves(observations, {.splits = splits, .calibration = options});
  json["halves"] = halves_json(result);
  json["halves"]["distances"] = distances_json(result);
  for (const std::string& doubt : halves_doubts(result)) json["warnings"].push_back(doubt);
}

}  // namespace

Json report_validation(const RigEstimate& estimate,
                       const RigEstimate& usual,
                       const std::string& file,
                       const Session& session) {
  Json json{{"notes", Json::array()}, {"warnings", Json::array()}};
  const auto note = [&](const std::string& words) { json["notes"].push_back(words); };
  if (!estimate.covariance) {
    note("No cross-validation: the rig file has no covariance.");
    return json;
  }
  if (estimate.calibration->prior_dof > 0 || estimate.calibration->source != "board") {
    note(
        "Cross-validation is only available for calibrations from boards alone; this one also used "
        "a prior or matched pairs.");
    return json;
  }
  try {
    add_models(usual, options_to_solve_again(usual), json);
  } catch (const Error& error) {
    note(fmt::format("Lens models were not compared: {}.", error.what()));
  }
  const BoardObservations observations = at_frames(
      estimate.evidence->observations, evenly_spaced(estimate.evidence->frames, max_frames));
  CalibrationOptions options = options_to_solve_again(with_default_names(estimate));
  try {
    add_halves(observations, options, file, session, json);
  } catch (const Error& error) {
    note(fmt::format("Halves of the views were not compared: {}.", error.what()));
  }
  options.board_shape = options.motion = false;  // lengths are those of the board as it was made
  try {
    add_left_out(observations, options, file, session, json);
  } catch (const Error& error) {
    note(fmt::format("No boards were held out: {}.", error.what()));
  }
  return json;
}

}  // namespace vernier::cli
