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

/// What the command line says of the board and where its corners come from: images, a corners file
/// or an observations file. The verbs that calibrate share it.
struct BoardInput {
  std::string verb;                  ///< for messages
  const CLI::App* app = nullptr;     ///< the verb, to tell what the command line gave
  std::string left, right;           ///< patterns of images; left alone is one camera
  std::vector<std::string> cameras;  ///< instead, a pattern a camera
  std::string corners, observations, size;

  std::string board, target;  ///< --board in words, or Kalibr's file
  double square_m = 0, marker_m = 0, tag_m = 0, tag_spacing = 0.3;
  std::string dictionary = "4x4_50", family = "36h11";
  int border_bits = 0;
  bool legacy = false, top_row_first = false;
};

/// Adds the options of the images and the board alone (detect).
void add_image_options(CLI::App* verb, BoardInput& input);

/// Adds all options that say where corners come from. `input` must outlive the parsing.
void add_board_options(CLI::App* verb, BoardInput& input);

/// The names of all these.
inline constexpr std::array board_options{
    "--left",         "--right",    "--camera",      "--board",         "--target",
    "--square-m",     "--marker-m", "--dictionary",  "--legacy",        "--tag-m",
    "--tag-spacing",  "--family",   "--border-bits", "--top-row-first", "--corners",
    "--observations", "--size"};

/// The patterns of the cameras' images, first camera first. Throws Error where they are said twice
/// or not at all.
std::vector<std::string> image_patterns(const BoardInput& input);

/// The files that the input is read from, the images among them.
std::vector<std::filesystem::path> files_named(const BoardInput& input);

/// The board. Throws Error where it is not given in full, or more is given than it has.
BoardTarget target_of(const BoardInput& input);

/// Reads or detects the corners; images without a board are warned of. Throws Error for options
/// that this kind of input has no use for.
BoardObservations load(const BoardInput& input, Session& session);

}  // namespace vernier::cli
