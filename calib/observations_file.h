// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/board_observations.h"
#include "calib/board_target.h"

namespace vernier {

/// Reads `frame,camera,row,col,X,Y,Z,qx,qy` (further columns ignored, target metres, pixels).
/// Every (row, col) must have one place on the target, and one line a frame and camera; frames are
/// 0 or above, cameras 0 to 1023. Throws Error with file and line.
BoardObservations read_observations(const std::filesystem::path& file,
                                    const std::vector<Eigen::Vector2i>& size_px);

/// Writes the same columns; numbers are exact (shortest form that reads back equal).
void write_observations(const BoardObservations& observations, const std::filesystem::path& file);

/// Corners in mrcal's format: a line `# filename x y level`, then per image one line a corner in
/// the order of the target's indices (a chessboard's row by row), "-" for x, y, level where one was
/// not found. An image's frame is the last number in its name and its camera the rest of the name,
/// in order of first appearance (left01.jpg and right01.jpg: frame 1 of cameras 0 and 1). A level
/// below 0 means as much as "-". Level k > 0 says that the corner was found in an image reduced 2^k
/// times; such corners weigh here as much as others, which count_coarse_corners lets you find out.
/// Throws Error with file and line, and for a target that cannot be.
BoardObservations read_corners(const std::filesystem::path& file,
                               const BoardTarget& target,
                               const std::vector<Eigen::Vector2i>& size_px);

/// How many corners of a corners file have a level above 0: coarser by 2^level, mrcal gives them
/// the weight 1/2^level.
int count_coarse_corners(const std::filesystem::path& file);

/// Writes camera after camera, so that reading counts them alike; a view without corners is one
/// line of dashes. Throws Error for an image whose name would not read back: one that is empty,
/// holds blanks, begins with '#', has no number, or does not go with its camera.
void write_corners(const BoardObservations& observations,
                   const BoardTarget& target,
                   const std::filesystem::path& file);

}  // namespace vernier
