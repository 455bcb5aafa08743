// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_detection.h"
#include "calib/error.h"
#include "cli/board_input.h"

namespace vernier::cli {
namespace {

struct Options {
  BoardInput input;
  std::string output;
};

void run(const Options& options, Session& session) {
  const auto [columns, rows] = parse_size(options.input.board, "--board");
  const Chessboard board{columns, rows, 1.0};
  const ImageDetections found = detect_images(image_patterns(options.input), board);
  write_corners(found, board, options.output);
  Json refused = Json::array();
  std::string text =
      fmt::format("{} boards found in {} frames, written to {}\n", found.observations.views.size(),
                  frames_of(found.observations).size(), options.output);
  for (const BoardDetection& image : found.refused) {
    refused.push_back({{"image", image.image.string()}, {"reason", image.reason}});
    text += fmt::format("  not used: {}: {}\n", image.image.string(), image.reason);
  }
  session.result({{"boards", found.observations.views.size()},
                  {"frames", frames_of(found.observations).size()},
                  {"refused", refused},
                  {"output", options.output}},
                 text);
}

}  // namespace

void add_detect(CLI::App& app, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, session, "detect", "find chessboard corners in image pairs",
                            "vernier detect --left 'left*.png' --right 'right*.png' --board 9x6 "
                            "-o corners.vnl");
  add_image_options(verb, options->input);
  verb->add_option("-o,--output", options->output, "corners file, in mrcal's format")->required();
  verb->callback(
      [options, &session] { session.action = [=, &session] { run(*options, session); }; });
}

}  // namespace vernier::cli
