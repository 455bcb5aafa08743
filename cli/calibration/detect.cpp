// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "calib/board_detection.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/observations_file.h"
#include "cli/calibration/board_input.h"
#include "cli/program/option_checks.h"
#include "cli/program/output_check.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

struct DetectArguments {
  BoardInput input;
  std::string output;
};

Json corners_json(const BoardDetection& image) {
  Json refused = Json::array();
  for (const RejectedCorner& corner : image.rejected_corners) {
    refused.push_back({{"corner", corner.id}, {"reason", text_of(corner.why)}});
  }
  return {{"image", image.image.string()},
          {"camera", image.camera},
          {"corners", image.ids.size()},
          {"refused_corners", refused}};
}

/// The board; lengths that detection does not need are optional.
BoardTarget shape_of(BoardInput input) {
  const bool charuco =
      input.board.rfind("charuco:", 0) == 0;  // needs the ratio of marker to square
  if (!(input.square_m > 0) && !charuco) input.square_m = 1;
  if (!(input.tag_m > 0)) input.tag_m = 1;
  return target_of(input);
}

void run(const DetectArguments& options, Session& session) {
  const BoardTarget target = shape_of(options.input);
  check_target(target);
  check_output_is_not_input(files_named(options.input), options.output);
  for (const std::string& pattern : image_patterns(options.input)) {
    for (const auto& file : matching_files(pattern)) check_corners_image(file.string());
  }
  const ImageDetections found = detect_images(image_patterns(options.input), target);
  write_corners(found, target, options.output);
  Json used = Json::array(), refused = Json::array();
  std::string text =
      fmt::format("{} boards detected in {} frames, written to {}\n", found.used.size(),
                  frames_of(found.observations).size(), options.output);
  for (const BoardDetection& image : found.used) {
    used.push_back(corners_json(image));
    if (image.rejected_corners.empty()) continue;
    text += fmt::format("  {}: {} corners used; rejected: {}\n", image.image.string(),
                        image.ids.size(), rejected_corners_text(image));
  }
  for (const BoardDetection& image : found.refused) {
    refused.push_back({{"image", image.image.string()}, {"reason", image.reason}});
    text += fmt::format("  rejected: {}: {}\n", image.image.string(), image.reason);
  }
  session.result({{"boards", found.used.size()},
                  {"frames", frames_of(found.observations).size()},
                  {"corners_per_board", found.observations.target_m.size()},
                  {"used", used},
                  {"refused", refused},
                  {"output", options.output}},
                 text);
}

}  // namespace

void add_detect(CLI::App& app, Session& session) {
  auto options = std::make_shared<DetectArguments>();
  CLI::App* verb =
      add_verb(app, session, "detect", "detect board corners in images",
               "vernier detect --left 'left*.png' --right 'right*.png' --board 9x6 "
               "-o corners.vnl\n"
               "  vernier detect --left 'left*.png' --board charuco:8x6 --square-m 0.03 "
               "--marker-m 0.022 --dictionary 4x4_50 -o corners.vnl\n"
               "  vernier detect --camera 'a*.png' --camera 'b*.png' --camera 'c*.png' "
               "--target aprilgrid.yaml -o corners.vnl");
  add_image_options(verb, options->input);
  verb->add_option("-o,--output", options->output, "corners file, in mrcal's format")->required();
  check_files_written(*verb, {"--output"});
  verb->callback(
      [options, &session] { session.action = [=, &session] { run(*options, session); }; });
}

}  // namespace vernier::cli
