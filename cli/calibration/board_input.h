// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"
#include "cli/program/cli11_fwd.h"
#include "cli/program/session.h"

namespace vernier::cli {

/// Command-line input of a board and its corners: images, a corners file or an observations file.
/// Shared by the calibrating verbs.
struct BoardInput {
  std::string verb;                  ///< for messages
  const CLI::App* app = nullptr;     ///< the verb, to check which options were given
  std::string left, right;           ///< image patterns; left alone is a single camera
  std::vector<std::string> cameras;  ///< alternatively, one pattern per camera
  std::string corners, observations, size;

  std::string board, target;  ///< value of --board, or Kalibr target file
  double square_m = 0, marker_m = 0, tag_m = 0, tag_spacing = 0.3;
  std::string dictionary = "4x4_50", family = "36h11";
  int border_bits = 0;
  bool legacy = false, top_row_first = false;
};

/// Adds only the options of images and board (detect).
void add_image_options(CLI::App* verb, BoardInput& input);

/// Adds all options that define the source of the corners. `input` must outlive the parsing.
void add_board_options(CLI::App* verb, BoardInput& input);

/// The names of all these options.
inline constexpr std::array board_options{
    "--left",         "--right",    "--camera",      "--board",         "--target",
    "--square-m",     "--marker-m", "--dictionary",  "--legacy",        "--tag-m",
    "--tag-spacing",  "--family",   "--border-bits", "--top-row-first", "--corners",
    "--observations", "--size"};

/// The image patterns, one per camera in order. Throws Error if they are missing or contradictory.
std::vector<std::string> image_patterns(const BoardInput& input);

/// The input files, including the images.
std::vector<std::filesystem::path> files_named(const BoardInput& input);

/// The board. Throws Error if options are missing or do not apply to this kind of board.
BoardTarget target_of(const BoardInput& input);

/// Reads or detects the corners; warns about images without a board. Throws Error for options that
/// do not apply to this kind of input.
BoardObservations load(const BoardInput& input, Session& session);

}  // namespace vernier::cli
