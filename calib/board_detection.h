// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/board_observations.h"

namespace vernier {

/// What became of one image.
struct BoardDetection {
  std::filesystem::path image;
  Eigen::Vector2i size_px{0, 0};
  std::vector<Eigen::Vector2d> corners_px;  ///< row by row; empty where no board was found
  std::string reason;                       ///< why not, where not
  int camera = 0;                           ///< index of the pattern it came by
};

/// Finds a chessboard: OpenCV's two finders in turn, then always sub-pixel refinement by the
/// gradient's orthogonality (Förstner and Gülch 1987, as cornerSubPix does it) in a window of at
/// most 0.35 of the smallest corner spacing, so that it holds no other corner. The order of corners
/// is made one and the same in every image of a board whose colours allow it (columns + rows odd):
/// x along rows, y down, the square between the first four corners dark. Throws Error for an image
/// that cannot be read.
BoardDetection detect_board(const std::filesystem::path& image, const Chessboard& board);

/// Files that match a pattern (shell globbing of the last component), in the order of their
/// names. Throws Error where there are none.
std::vector<std::filesystem::path> matching_files(const std::string& pattern);

/// What became of the images of a rig.
struct ImageDetections {
  BoardObservations observations;
  std::vector<BoardDetection> refused;  ///< images without a board
};

/// Observations from the images of one or more cameras, one pattern a camera: images of the same
/// number are one frame. Frames whose board was found by some cameras only count for those. Throws
/// Error where a camera has no frame number in common with those before it, sizes disagree, or no
/// board is found.
ImageDetections detect_images(const std::vector<std::string>& patterns, const Chessboard& board);

/// A corners file of all the images, with a line of dashes for each that was refused.
void write_corners(const ImageDetections& found,
                   const Chessboard& board,
                   const std::filesystem::path& file);

}  // namespace vernier
