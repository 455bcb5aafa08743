// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/board_input.h"

#include "calib/board_detection.h"
#include "calib/error.h"
#include "calib/observations_file.h"

namespace vernier::cli {
namespace {

bool has_images(const BoardInput& input) {
  return !input.left.empty() || !input.right.empty() || !input.cameras.empty();
}

std::vector<Eigen::Vector2i> size_of(const BoardInput& input) {
  if (input.size.empty()) {
    throw Error(input.verb, "the image size is not given", "give --size, such as 640x480");
  }
  const auto [width, height] = parse_size(input.size, "--size");
  return {{width, height}};
}

}  // namespace

void add_image_options(CLI::App* verb, BoardInput& input) {
  input.verb = verb->get_name();
  verb->add_option("--left", input.left, "left images (a quoted pattern); alone: one camera");
  verb->add_option("--right", input.right, "right images; the same number, the same frame");
  verb->add_option("--camera", input.cameras,
                   "images of one camera, instead of --left and --right; once for each camera")
      ->allow_extra_args(false);
  verb->add_option("--board", input.board, "inner corners, such as 9x6");
}

void add_board_options(CLI::App* verb, BoardInput& input) {
  add_image_options(verb, input);
  verb->add_option("--corners", input.corners, "corners file of vernier detect or mrcal");
  verb->add_option("--observations", input.observations,
                   "CSV frame,camera,row,col,X,Y,Z,qx,qy (metres, pixels)");
  verb->add_option("--square-m", input.square_m, "side of a square, metres");
  verb->add_option("--size", input.size, "image size, such as 640x480 (for corners, observations)");
}

std::vector<std::string> image_patterns(const BoardInput& input) {
  if (!input.cameras.empty()) {
    if (!input.left.empty() || !input.right.empty()) {
      throw Error(input.verb, "--camera stands beside --left or --right", "give one kind");
    }
    return input.cameras;
  }
  if (input.left.empty()) {
    throw Error(input.verb, input.right.empty() ? "no images are given" : "--left is missing",
                "give --left and --right, --left alone for one camera, or --camera for each of "
                "several");
  }
  if (input.right.empty()) return {input.left};
  return {input.left, input.right};
}

Chessboard board_of(const BoardInput& input) {
  if (input.board.empty() || !(input.square_m > 0)) {
    throw Error(input.verb, "the board is not given",
                "give --board (inner corners, such as 9x6) and --square-m (side of a square in "
                "metres, above 0)");
  }
  const auto [columns, rows] = parse_size(input.board, "--board");
  return {columns, rows, input.square_m};
}

BoardObservations load(const BoardInput& input, Session& session) {
  const int sources =
      !input.corners.empty() + !input.observations.empty() + (has_images(input) ? 1 : 0);
  if (sources != 1) {
    throw Error(input.verb, "give exactly one kind of input",
                "images (--left, --right, --camera), or --corners, or --observations");
  }
  if (!input.observations.empty()) return read_observations(input.observations, size_of(input));
  if (!input.corners.empty()) return read_corners(input.corners, board_of(input), size_of(input));
  ImageDetections found = detect_images(image_patterns(input), board_of(input));
  for (const BoardDetection& image : found.refused) {
    session.warn(image.image.string() + ": " + image.reason);
  }
  return std::move(found.observations);
}

}  // namespace vernier::cli
