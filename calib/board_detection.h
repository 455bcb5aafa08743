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
  int camera = 0;                           ///< of a pair: 0 left, 1 right
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

/// Observations of a stereo pair's images: left and right images of the same number are one frame.
/// Frames whose board was found in only one image count for that camera. Throws Error where
/// numbers do not pair at all, sizes disagree, or no board is found.
struct PairDetections {
  BoardObservations observations;
  std::vector<BoardDetection> refused;  ///< images without a board
};
PairDetections detect_pairs(const std::string& left_pattern,
                            const std::string& right_pattern,
                            const Chessboard& board);

/// A corners file of all the images, with a line of dashes for each that was refused.
void write_corners(const PairDetections& found,
                   const Chessboard& board,
                   const std::filesystem::path& file);

}  // namespace vernier
