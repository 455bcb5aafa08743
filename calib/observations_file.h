// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"

namespace vernier {

/// Reads `frame,camera,row,col,X,Y,Z,qx,qy` (further columns ignored, target in metres, pixels).
/// Every (row, col) must have one position on the target, and one line per frame and camera; frames
/// are 0 or above, cameras 0 to 1023. Throws Error with file and line.
BoardObservations read_observations(const std::filesystem::path& file,
                                    const std::vector<Eigen::Vector2i>& size_px);

/// Writes the same columns; numbers are exact (shortest form that reads back equal).
void write_observations(const BoardObservations& observations, const std::filesystem::path& file);

/// Corners in mrcal's format: a line `# filename x y level`, then for each image one line per
/// corner in the order of the target's indices (row by row for a chessboard), "-" for x, y, level
/// if it was not found. The frame of an image is the last number in its name and its camera the
/// rest of the name, numbered by first appearance (left01.jpg and right01.jpg: frame 1 of cameras 0
/// and 1). A level below 0 is equivalent to "-". Level k > 0 means that the corner was found in an
/// image reduced 2^k times; such corners have full weight here, see count_coarse_corners. Throws
/// Error with file and line, and for an invalid target.
BoardObservations read_corners(const std::filesystem::path& file,
                               const BoardTarget& target,
                               const std::vector<Eigen::Vector2i>& size_px);

/// Number of corners with a level above 0 in a corners file: coarser by 2^level, weighted by
/// 1/2^level in mrcal.
int count_coarse_corners(const std::filesystem::path& file);

/// Throws Error for the name of an image that a corners file cannot hold: one with blanks, or that
/// begins with '#'.
void check_corners_image(const std::string& image);

/// Writes camera by camera, so that reading numbers them in the same way; a view without corners is
/// one line of dashes. Throws Error for an image whose name would not read back: one that is empty,
/// contains blanks, begins with '#', has no number, or does not match its camera.
void write_corners(const BoardObservations& observations,
                   const BoardTarget& target,
                   const std::filesystem::path& file);

}  // namespace vernier
