// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/calibrate.h"

#include "calib/board_detection.h"
#include "calib/error.h"
#include "calib/observations_file.h"
#include "calib/rig_file.h"
#include "cli/rig_table.h"
#include "cli/session.h"

namespace vernier::cli {
namespace {

struct Options {
  std::string left, right, corners, observations, board, size, model = "radial1", output;
  double square_m = 0, pixel_sigma_px = 0;
  bool no_evidence = false;
};

Chessboard board_of(const Options& options) {
  if (options.board.empty() || !(options.square_m > 0)) {
    throw Error("calibrate", "the board is not given",
                "give --board (inner corners, such as 9x6) and --square-m (side of a square in "
                "metres, above 0)");
  }
  const auto [columns, rows] = parse_size(options.board, "--board");
  return {columns, rows, options.square_m};
}

std::vector<Eigen::Vector2i> size_of(const Options& options) {
  if (options.size.empty()) {
    throw Error("calibrate", "the image size is not given", "give --size, such as 640x480");
  }
  const auto [width, height] = parse_size(options.size, "--size");
  return {{width, height}};
}

BoardObservations load(const Options& options, Session& session) {
  const int sources = !options.corners.empty() + !options.observations.empty() +
                      (!options.left.empty() || !options.right.empty());
  if (sources != 1) {
    throw Error("calibrate", "give exactly one kind of input",
                "--left and --right, or --corners, or --observations");
  }
  if (!options.observations.empty()) {
    return read_observations(options.observations, size_of(options));
  }
  if (!options.corners.empty()) {
    return read_corners(options.corners, board_of(options), size_of(options));
  }
  if (options.left.empty() || options.right.empty()) {
    throw Error("calibrate", "one of --left and --right is missing", "give both");
  }
  PairDetections found = detect_pairs(options.left, options.right, board_of(options));
  for (const BoardDetection& image : found.refused) {
    session.warn(image.image.string() + ": " + image.reason);
  }
  return std::move(found.observations);
}

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
  const RigEstimate estimate = calibrate(load(options, session), calibration);
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
  verb->add_option("--left", o->left, "left images (a quoted pattern)");
  verb->add_option("--right", o->right, "right images; the same number, the same frame");
  verb->add_option("--corners", o->corners, "corners file of vernier detect or mrcal");
  verb->add_option("--observations", o->observations,
                   "CSV frame,camera,row,col,X,Y,Z,qx,qy (metres, pixels)");
  verb->add_option("--board", o->board, "inner corners, such as 9x6");
  verb->add_option("--square-m", o->square_m, "side of a square, metres");
  verb->add_option("--size", o->size, "image size, such as 640x480 (for corners and observations)");
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
