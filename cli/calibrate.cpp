// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibrate.h"

#include "calib/rig_file.h"
#include "cli/board_input.h"
#include "cli/rig_table.h"
#include "cli/session.h"

namespace vernier::cli {
namespace {

struct Options {
  BoardInput board;
  std::string model = "radial1", output;
  double pixel_sigma_px = 0;
  bool no_evidence = false;
};

void judge(const RigEstimate& estimate, Session& session) {
  const CalibrationSummary& summary = *estimate.calibration;
  for (const std::string& warning : summary.warnings) session.warn(warning);
  if (summary.rms_px > 1) {
    session.doubt(fmt::format(
        "residuals of {:.2f} px are no corner noise: the board is not flat, corners are wrong, or "
        "the lens needs another model",
        summary.rms_px));
  }
}

void run(const Options& options, Session& session) {
  const CalibrationOptions calibration{.model = camera_model(options.model),
                                       .pixel_sigma_px = options.pixel_sigma_px};
  const RigEstimate estimate = calibrate(load(options.board, session), calibration);
  write_rig(estimate, options.output, options.no_evidence ? KeepEvidence::no : KeepEvidence::yes);
  judge(estimate, session);
  Json json = rig_json(estimate);
  json["output"] = options.output;
  session.result(json, rig_table(estimate) + fmt::format("written to {}\n", options.output));
}

}  // namespace

void add_calibrate(CLI::App& app, Session& session) {
  auto o = std::make_shared<Options>();
  CLI::App* verb =
      add_verb(app, session, "calibrate", "calibrate a rig from images or corners of a chessboard",
               "vernier calibrate --left 'left*.png' --right 'right*.png' --board 9x6 "
               "--square-m 0.025 -o rig.json");
  add_board_options(verb, o->board);
  verb->add_option("--model", o->model, "pinhole, radial1, opencv4, opencv5, opencv8 or fisheye4")
      ->capture_default_str();
  verb->add_option("--pixel-sigma", o->pixel_sigma_px,
                   "noise of a pixel coordinate (else estimated from the residuals)")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--no-evidence", o->no_evidence, "leave the corners out of the rig file");
  verb->add_option("-o,--output", o->output, "rig file")->required();
  verb->callback([o, &session] { session.action = [=, &session] { run(*o, session); }; });
}

}  // namespace vernier::cli
