// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/calibration/board_input.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>
#include <variant>

#include "calib/base/shown_text.h"
#include "calib/board/kalibr_target.h"
#include "calib/board_detection.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "calib/calibration/observation_checks.h"
#include "calib/error.h"
#include "calib/observations_file.h"
#include "cli/program/limited_grid.h"
#include "cli/program/option_checks.h"
#include "cli/program/session.h"

namespace vernier::cli {
namespace {

bool has_images(const BoardInput& input) {
  return !input.left.empty() || !input.right.empty() || !input.cameras.empty();
}

std::vector<Eigen::Vector2i> size_of(const BoardInput& input) {
  if (input.size.empty()) {
    throw Error(input.verb, "image size missing", "give --size, for example 640x480");
  }
  std::vector<Eigen::Vector2i> sizes;
  for (const auto& [width, height] : parse_sizes(input.size, "--size")) {
    sizes.emplace_back(width, height);
  }
  return sizes;
}

double length(const BoardInput& input, double metres, const std::string& option) {
  if (!(metres > 0)) {
    throw Error(input.verb, option + " is missing or not positive", "give the length in metres");
  }
  return metres;
}

// Options that only apply to one kind of board.
constexpr int most_corners = 10'000;  ///< of a board
constexpr std::array charuco_options{"--marker-m", "--dictionary", "--legacy"};
constexpr std::array tag_options{"--tag-m", "--tag-spacing"};
constexpr std::array tag_detection_options{"--family", "--border-bits", "--top-row-first"};

void refuse(const BoardInput& input, std::span<const char* const> options, const std::string& why) {
  refuse_options(*input.app, options, why);
}

void add_tag_options(const BoardInput& input, AprilTagGrid& grid) {
  grid.border_bits = input.border_bits;
  grid.family = input.family;
  grid.top_row_first = input.top_row_first;
}

BoardTarget kalibr_target(const BoardInput& input) {
  if (!input.board.empty())
    throw Error(input.verb, "--target and --board are mutually exclusive", "give one of them");
  refuse(input, std::array{"--square-m"}, "already given by the --target file");
  refuse(input, tag_options, "already given by the --target file");
  refuse(input, charuco_options, "the --target file is not a charuco board");
  BoardTarget target = read_kalibr_target(input.target);
  if (auto* grid = std::get_if<AprilTagGrid>(&target)) {
    add_tag_options(input, *grid);
  } else {
    refuse(input, tag_detection_options, "the --target file is a chessboard and has no tags");
  }
  return target;
}

/// Checks corners from a file; error messages start with the file name.
BoardObservations checked(const std::string& file, BoardObservations observations) {
  try {
    check_observations(observations);
  } catch (const Error& error) {
    throw Error(file, error.place() + ": " + error.fault(), error.remedy());
  }
  return observations;
}

/// Sizes for more cameras than there are.
void check_sizes(const BoardInput& input, const BoardObservations& observations) {
  int cameras = 0;
  for (const BoardView& view : observations.views) cameras = std::max(cameras, view.camera + 1);
  const auto sizes = static_cast<int>(size_of(input).size());
  if (sizes <= std::max(cameras, 1)) return;
  throw Error(
      "--size " + input.size,
      fmt::format("gives {} sizes, and there are corners of {}", sizes, counted(cameras, "camera")),
      "give one size for all cameras, or one for each");
}

BoardObservations from_observations(const BoardInput& input) {
  const std::string why = "the --observations file contains the board's points";
  refuse(input, std::array{"--board", "--target", "--square-m"}, why);
  refuse(input, charuco_options, why);
  refuse(input, tag_options, why);
  refuse(input, tag_detection_options, why);
  BoardObservations observations = read_observations(input.observations, size_of(input));
  check_sizes(input, observations);
  return checked(input.observations, std::move(observations));
}

BoardObservations from_corners(const BoardInput& input, Session& session) {
  BoardObservations observations = read_corners(input.corners, target_of(input), size_of(input));
  check_sizes(input, observations);
  observations = checked(input.corners, std::move(observations));
  if (const int coarse = count_coarse_corners(input.corners)) {
    session.warn(
        fmt::format("{}: {} corners have a level above 0 (detected in a reduced image) but get the "
                    "same weight as the others",
                    input.corners, coarse));
  }
  return observations;
}

}  // namespace

void add_image_options(CLI::App* verb, BoardInput& input) {
  input.verb = verb->get_name();
  input.app = verb;
  verb->add_option("--left", input.left,
                   "left images (quoted pattern); without --right: a single camera");
  verb->add_option("--right", input.right,
                   "right images (quoted pattern); matched to left images by number");
  verb->add_option("--camera", input.cameras,
                   "images of one camera; repeat for each camera, instead of --left and --right")
      ->allow_extra_args(false);
  verb->add_option("--board", input.board,
                   "9x6 (inner corners), charuco:8x6 (squares) or apriltag:6x6 (tags)");
  verb->add_option("--target", input.target, "Kalibr target file (YAML), instead of --board");
  verb->add_option("--square-m", input.square_m, "square size, metres")->check(finite_and_positive);
  verb->add_option("--marker-m", input.marker_m, "marker size of a charuco board, metres")
      ->check(finite_and_positive);
  verb->add_option("--dictionary", input.dictionary, "OpenCV marker dictionary of a charuco board")
      ->capture_default_str();
  verb->add_flag("--legacy", input.legacy, "charuco board layout of OpenCV before 4.6");
  verb->add_option("--tag-m", input.tag_m, "AprilTag size including the black border, metres")
      ->check(finite_and_positive);
  verb->add_option("--tag-spacing", input.tag_spacing,
                   "gap between AprilTags divided by their size")
      ->check(finite_and_positive)
      ->capture_default_str();
  verb->add_option("--family", input.family, "AprilTag family: 16h5, 25h9, 36h10 or 36h11")
      ->capture_default_str();
  verb->add_option("--border-bits", input.border_bits,
                   "black border of an AprilTag: 1 or 2 bits (default: try both)");
  verb->add_flag("--top-row-first", input.top_row_first,
                 "AprilTag ids start in the top row (Kalibr: in the bottom row)");
}

void add_board_options(CLI::App* verb, BoardInput& input) {
  add_image_options(verb, input);
  verb->add_option("--corners", input.corners, "corners file from vernier detect or mrcal (.vnl)");
  verb->add_option("--observations", input.observations,
                   "CSV frame,camera,row,col,X,Y,Z,qx,qy (metres, pixels)");
  verb->add_option("--size", input.size,
                   "image size, such as 640x480, or one for each camera: 640x480,960x720 (for "
                   "--corners and --observations)");
}

std::vector<std::string> image_patterns(const BoardInput& input) {
  if (!input.cameras.empty()) {
    if (!input.left.empty() || !input.right.empty()) {
      throw Error(input.verb, "--camera cannot be combined with --left or --right",
                  "give either --camera or --left/--right");
    }
    return input.cameras;
  }
  if (input.left.empty()) {
    throw Error(
        input.verb, input.right.empty() ? "no images given" : "--left is missing",
        "give --left and --right, --left alone for a single camera, or --camera for each camera");
  }
  if (input.right.empty()) return {input.left};
  return {input.left, input.right};
}

std::vector<std::filesystem::path> files_named(const BoardInput& input) {
  std::vector<std::filesystem::path> files{input.corners, input.observations, input.target};
  if (!has_images(input)) return files;
  for (const std::string& pattern : image_patterns(input)) {
    const std::vector<std::filesystem::path> images = matching_files(pattern);
    files.insert(files.end(), images.begin(), images.end());
  }
  return files;
}

BoardTarget target_of(const BoardInput& input) {
  if (!input.target.empty()) return kalibr_target(input);
  if (input.board.empty()) {
    throw Error(input.verb, "no board given",
                "give --board, such as 9x6 (inner corners), charuco:8x6 (squares) or apriltag:6x6 "
                "(tags), or --target with a Kalibr target file");
  }
  const auto colon = input.board.find(':');
  const std::string kind = colon == std::string::npos ? "" : input.board.substr(0, colon);
  const auto [columns, rows] =
      parse_limited_grid(input.board.substr(colon + 1), "--board", most_corners);
  if (kind != "charuco") refuse(input, charuco_options, "only valid for a charuco board");
  if (kind != "apriltag") {
    refuse(input, tag_options, "only valid for an AprilTag grid");
    refuse(input, tag_detection_options, "only valid for an AprilTag grid");
  }
  if (kind.empty()) return Chessboard{columns, rows, length(input, input.square_m, "--square-m")};
  if (kind == "charuco") {
    return CharucoBoard{columns,
                        rows,
                        length(input, input.square_m, "--square-m"),
                        length(input, input.marker_m, "--marker-m"),
                        input.dictionary,
                        input.legacy};
  }
  if (kind == "apriltag") {
    refuse(input, std::array{"--square-m"}, "an AprilTag grid has no squares; use --tag-m");
    AprilTagGrid grid{columns, rows, length(input, input.tag_m, "--tag-m"), input.tag_spacing};
    add_tag_options(input, grid);
    return grid;
  }
  throw Error("--board", "unknown kind of board " + in_quotes(kind),
              "use 9x6, charuco:8x6 or apriltag:6x6");
}

BoardObservations load(const BoardInput& input, Session& session) {
  const int sources =
      !input.corners.empty() + !input.observations.empty() + (has_images(input) ? 1 : 0);
  if (sources != 1) {
    throw Error(input.verb, "exactly one kind of input is required",
                "give images (--left, --right or --camera), --corners or --observations");
  }
  if (!input.observations.empty()) return from_observations(input);
  if (!input.corners.empty()) return from_corners(input, session);
  refuse(input, std::array{"--size"}, "the size is read from the images");
  ImageDetections found = detect_images(image_patterns(input), target_of(input));
  for (const BoardDetection& image : found.refused) {
    session.warn(image.image.string() + ": " + image.reason);
  }
  for (const BoardDetection& image : found.used) {
    if (image.rejected_corners.empty()) continue;
    session.warn(image.image.string() + ": not used: " + rejected_corners_text(image));
  }
  return std::move(found.observations);
}

}  // namespace vernier::cli
