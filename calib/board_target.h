// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

namespace vernier {

/// A chessboard by its inner corners, row by row: x along the rows, y from row to row.
struct Chessboard {
  int columns = 9;
  int rows = 6;
  double square_m = 0.025;  ///< distance between columns
  double row_m = 0;         ///< distance between rows if it differs; 0: square_m
};

/// A chessboard whose white squares hold ArUco markers, as OpenCV 4.6 draws it: the square in the
/// upper left corner is black, markers count row by row from there. Its corners are the inner
/// corners of the chessboard, row by row, the first at the origin, x right, y down.
struct CharucoBoard {
  int columns = 8;  ///< squares
  int rows = 6;     ///< squares
  double square_m = 0.03;
  double marker_m = 0.022;
  std::string dictionary = "4x4_50";
  /// The layout before OpenCV 4.6: the square in the lower left corner is black. Differs only for
  /// an even number of rows.
  bool legacy = false;
};

/// A grid of AprilTags as Kalibr draws it: tag 0 at the lower left, tags count to the right and
/// then upwards. The frame is Kalibr's: origin at the lower left corner of tag 0, x right, y up, z
/// towards the viewer. Corner (row r, column c) of the 2 rows x 2 columns grid is point
/// 2 columns r + c:
///
///     8------9   10-----11
///     | tag 2 |  | tag 3 |      e.g. 2 x 2 tags: tag 0 has points 0 1 4 5, tag 3 has 10 11 14 15
///     4------5   6-------7      (r counts upwards)
struct AprilTagGrid {
  int columns = 6;               ///< tags
  int rows = 6;                  ///< tags
  double tag_m = 0.088;          ///< side of a tag over its black border
  double spacing = 0.3;          ///< gap between tags divided by the side of a tag
  int border_bits = 0;           ///< width of the black border, 1 or 2 (Kalibr's); 0: detect it
  std::string family = "36h11";  ///< 16h5, 25h9, 36h10, 36h11
  bool top_row_first = false;    ///< tags are numbered from the upper left, row by row downwards
};

/// The target to be detected in images.
using BoardTarget = std::variant<Chessboard, CharucoBoard, AprilTagGrid>;

/// Throws Error for an invalid target: too few corners or more than 1000 per side, a size not above
/// 0, a marker larger than its square, an unknown dictionary, or more tags than the family has.
void check_target(const BoardTarget& target);

/// Corner positions on the target in the order of their indices, z = 0, metres.
std::vector<Eigen::Vector3d> target_points(const BoardTarget& target);

/// Columns and rows of the grid of corners.
Eigen::Vector2i corner_grid(const BoardTarget& target);

/// Description: "9x6 board", "8x6 ChArUco board", "6x6 AprilTag grid".
std::string name_of(const BoardTarget& target);

}  // namespace vernier
