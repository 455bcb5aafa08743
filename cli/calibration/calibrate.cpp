// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibrate.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/calibration/effects.h"
#include "calib/noise/board_tests.h"
#include "calib/noise/component_tests.h"
#include "calib/rig.h"
#include "calib/rig_estimate.h"
#include "calib/rig_file.h"
#include "calib/validation/model_comparison.h"
#include "calib/validation/residual_structure.h"
#include "cli/calibration/board_input.h"
#include "cli/calibration/calibrate_pairs.h"
#include "cli/calibration/component_test.h"
#include "cli/calibration/found_effects.h"
#include "cli/calibration/solver_input.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/rig_table.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

struct CalibrateArguments {
  BoardInput board;
  SolverInput solver;
  std::string output, pairs;
  bool no_evidence = false, no_model_check = false;
};

Json comparison_json(const ModelComparison& comparison) {
  const auto score = [](const ModelScore& s) {
    return Json{{"model", s.name},
                {"held_out_rms_px", s.held_out_rms_px},
                {"fitted_rms_px", s.fitted_rms_px},
                {"better_views", s.better_views},
                {"gain_sigmas", s.gain_sigmas},
                {"largest_move", s.largest_move},
                {"largest_move_sigmas", s.largest_move_sigmas}};
  };
  Json json{{"frames", comparison.frames}, {"in_use", score(comparison.in_use)}};
  json["richer"] = Json::array();
  for (const ModelScore& s : comparison.richer) json["richer"].push_back(score(s));
  if (!comparison.left_out.empty()) json["left_out"] = comparison.left_out;
  return json;
}

std::string comparison_table(const ModelComparison& comparison) {
  std::string text = fmt::format(
      "lens models on held-out views ({} frames):\n{:<10} {:>12} {:>12} {:>13}  {}\n",
      comparison.frames, "model", "held-out px", "fitted px", "views better", "largest change");
  const auto line = [&](const ModelScore& s) {
    text += fmt::format("{:<10} {:>12.4f} {:>12.4f} {:>13}  {}\n", s.name, s.held_out_rms_px,
                        s.fitted_rms_px, s.name == comparison.in_use.name ? 0 : s.better_views,
                        s.largest_move.empty() ? ""
                                               : fmt::format("{} by {:.1f} sigma", s.largest_move,
                                                             s.largest_move_sigmas));
  };
  line(comparison.in_use);
  for (const ModelScore& s : comparison.richer) line(s);
  if (!comparison.left_out.empty()) text += "not compared: " + comparison.left_out + "\n";
  return text;
}

void report_warnings(const RigEstimate& estimate, Session& session) {
  const CalibrationSummary& summary = *estimate.calibration;
  for (const std::string& warning : summary.warnings) session.warn(warning);
  for (const std::string& warning : summary.trust_warnings) session.add_trust_warning(warning);
}

/// Root mean square residuals of each camera; empty where a shape or motion of the board is
/// estimated, which the evidence does not hold: all motion would be the second camera's.
std::vector<double> rms_of_cameras(const RigEstimate& estimate) {
  std::vector<double> rms_px;
  if (estimate.calibration->effects) return {};
  for (std::size_t c = 0; c < estimate.rig.cameras.size(); ++c) {
    double squares = 0, corners = 0;
    for (const CornerResidual& at : residuals_of_camera(estimate, static_cast<int>(c))) {
      squares += at.residual_px.squaredNorm();
      ++corners;
    }
    rms_px.push_back(std::sqrt(squares / (2 * corners)));
  }
  return rms_px;
}

/// "residuals: left 0.150 px, right 0.612 px rms"; empty for one camera.
std::string rms_text(const Rig& rig, const std::vector<double>& rms_px) {
  if (rms_px.size() < 2) return "";
  std::string text = "residuals: ";
  for (std::size_t c = 0; c < rms_px.size(); ++c) {
    text += fmt::format("{}{} {:.3f} px", c > 0 ? ", " : "", rig.cameras[c].name, rms_px[c]);
  }
  return text + " rms of a coordinate\n";
}

/// " (p = 0.001)", or nothing for effects that were asked for.
template <class Test>
std::string found_text(const std::optional<Test>& test) {
  return test ? fmt::format(" ({})", p_text(test->p_value)) : "";
}

/// The random effects of the calibration, one a line, and the tests that found them.
std::string effects_text(const CalibrationEffects& effects, const EffectsTest& test) {
  std::string text =
      fmt::format("random effects: {:.3f} px white, {:.3f} px smooth over {:.0f} mm\n",
                  effects.white_px, effects.field_px, 1e3 * effects.field_length_m);
  if (effects.motion_m > 0) {
    text += fmt::format(
        "  the board moved between exposures: {} and {:.2f} mrad rms about each axis{}\n",
        motion_words(effects.motion_m, effects.motion_baseline_m), 1e3 * effects.motion_rad,
        found_text(test.motion));
  }
  if (!effects.shape_m.empty()) {
    text += fmt::format(
        "  the board is uneven: {:.3f} mm in height, {:.3f} mm in its plane, rms{}\n",
        1e3 * effects.shape_height_m, 1e3 * effects.shape_plane_m, found_text(test.shape));
    if (test.has_bend()) text += fmt::format("  the board is bent{}\n", found_text(test.bend));
  }
  return text;
}

std::string no_effects_text(const EffectsTest& test) {
  std::string text = "random effects of the board: ";
  text += test.not_tested.empty() ? "none in use" : "not looked for: " + test.not_tested;
  if (test.bend) text += "; no bend found, " + p_text(test.bend->p_value);
  if (test.shape) text += ", shape " + p_text(test.shape->p_value);
  if (test.motion) text += ", motion " + p_text(test.motion->p_value);
  return text + "\n";
}

/// What the views tell of the board's aspect; nothing if it was not tested.
std::string aspect_text(const EffectsTest& test) {
  if (!test.aspect) return "";
  const std::string p = p_text(test.aspect_p_value());
  if (test.has_aspect()) {
    return fmt::format(
        "the board's x and y are not in the ratio given ({}): its aspect is estimated, and "
        "which of the two is as given is open, so that the rig's scale is uncertain by {:.3f} %\n",
        p, 50 * std::abs(test.aspect->value));
  }
  const std::string found =
      fmt::format("board aspect: as given, {} (to {:.3f} %)\n", p, 100 * test.aspect->sigma);
  if (test.tells_aspect()) return found;
  return fmt::format(
      "board aspect: these views tell it from other fx and fy to {:.2f} % only: if the board "
      "may be stretched, turn it by 90 degrees in some views\n",
      100 * test.aspect->sigma);
}

Json aspect_test_json(const EffectsTest& test) {
  if (!test.aspect) return nullptr;
  Json json = aspect_json(*test.aspect);
  json["p_value"] = test.aspect_p_value();
  json["told"] = test.tells_aspect();
  return json;
}

/// Null for what was not tested.
Json effects_test_json(const EffectsTest& test) {
  Json json{{"shape", test_json(test.shape)},
            {"motion", test_json(test.motion)},
            {"isotropy", test_json(test.isotropy)},
            {"bend", test_json(test.bend)},
            {"aspect", aspect_test_json(test)}};
  if (!test.not_tested.empty()) json["not_tested"] = test.not_tested;
  return json;
}

void run(const CalibrateArguments& options, Session& session) {
  if (!options.pairs.empty()) {
    refuse_options(*options.board.app, board_options, "not used with --pairs, which need no board");
    refuse_options(*options.board.app, std::array{"--model", "--know"},
                   "with --pairs this comes from the prior");
    refuse_options(*options.board.app,
                   std::array{"--warp", "--no-model-check", "--board-shape", "--motion",
                              "--board-aspect", "--no-effects"},
                   "only valid for views of a board");
    refuse_options(*options.board.app, std::array{"--pixel-sigma"},
                   "the noise is taken from the pairs file and scaled by the residuals");
    calibrate_pairs(options.pairs, options.solver, options.output, !options.no_evidence, session);
    return;
  }
  check_output_is_not_input(files_named(options.board), options.output);
  check_output_is_not_input({options.solver.prior}, options.output);
  CalibrationOptions calibration = calibration_options(options.solver, session);
  const BoardObservations observations = load(options.board, session);
  auto [estimate, comparison, test] = calibrate_and_look(
      observations, calibration,
      {.effects = options.solver.looks_for_effects(), .models = !options.no_model_check});
  if (!options.no_model_check) {
    std::vector<std::string>& warnings = estimate.calibration->warnings;
    warnings.insert(warnings.end(), comparison.warnings.begin(), comparison.warnings.end());
    if (!comparison.not_compared.empty()) {
      warnings.push_back("lens models were not compared: " + comparison.not_compared);
    }
  }
  write_rig(estimate, options.output, options.no_evidence ? KeepEvidence::no : KeepEvidence::yes);
  report_warnings(estimate, session);
  Json json = rig_json(estimate);
  const std::vector<double> rms_px = rms_of_cameras(estimate);
  json["rms_px_of_cameras"] = rms_px;
  std::string text = rig_table(estimate) + rms_text(estimate.rig, rms_px);
  if (estimate.calibration->effects) {
    text += effects_text(*estimate.calibration->effects, test);
  } else if (options.solver.looks_for_effects()) {
    text += no_effects_text(test);
  }
  text += aspect_text(test);
  if (options.solver.looks_for_effects()) json["effects_test"] = effects_test_json(test);
  if (!comparison.richer.empty()) {
    json["model_comparison"] = comparison_json(comparison);
    text += comparison_table(comparison);
  }
  json["output"] = options.output;
  session.result(json, text + fmt::format("written to {}\n", options.output));
}

}  // namespace

void add_calibrate(CLI::App& app, Session& session) {
  auto o = std::make_shared<CalibrateArguments>();
  CLI::App* verb = add_verb(app, session, "calibrate",
                            "calibrate a rig from images or corners of a board, or from matched "
                            "corners of an arbitrary scene and a prior",
                            "vernier calibrate --left 'left*.png' --right 'right*.png' --board 9x6 "
                            "--square-m 0.025 -o rig.json\n"
                            "  vernier calibrate --pairs pairs.csv --prior prior.json -o rig.json");
  add_board_options(verb, o->board);
  add_solver_options(verb, o->solver);
  verb->add_option("--pairs", o->pairs,
                   "matched corners of an arbitrary scene (from vernier match); requires --prior");
  verb->add_flag("--no-model-check", o->no_model_check,
                 "skip the comparison with richer lens models on held-out views");
  verb->add_flag("--no-evidence", o->no_evidence, "do not store the corners in the rig file");
  verb->add_option("-o,--output", o->output, "rig file")->required();
  check_files_written(*verb, {"--output"});
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
