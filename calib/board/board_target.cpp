// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board_target.h"

#include <cmath>

#include "calib/board/marker_dictionary.h"
#include "calib/error.h"

namespace vernier {

using namespace internal;

namespace {

std::string size_text(int columns, int rows) {
  return std::to_string(columns) + "x" + std::to_string(rows);
}

/// A larger number is a typing error, and its square too many corners.
constexpr int max_along_a_side = 1000;

void require_few(int columns, int rows, const std::string& place) {
  if (columns > max_along_a_side || rows > max_along_a_side) {
    throw Error(place, "more than 1000 along a side", "check its size");
  }
}

void require_length(double metres, const std::string& place, const std::string& what) {
  if (!(metres > 0) || !std::isfinite(metres)) {
    throw Error(place, what + " is not above 0", "give it in metres");
  }
}

void require_markers(int needed, const std::string& dictionary, const std::string& place) {
  const int there = marker_dictionary(dictionary)->bytesList.rows;
  if (needed > there) {
    throw Error(place,
                "it has " + std::to_string(needed) + " markers, " + dictionary + " has " +
                    std::to_string(there),
                "check the size and the dictionary");
  }
}

void check(const Chessboard& board, const std::string& place) {
  if (board.columns < 3 || board.rows < 3) {
    throw Error(place, "fewer than 3 inner corners along a side",
                "count the inner corners, not the squares");
  }
  require_few(board.columns, board.rows, place);
  require_length(board.square_m, place, "the side of a square");
  if (board.row_m == 0) return;
  require_length(board.row_m, place, "the distance between rows");
  if (board.columns == board.rows && board.row_m != board.square_m) {
    throw Error(
        place,
        "its orientation is ambiguous: as many columns as rows, and squares that are not square",
        "use square squares, or different numbers of columns and rows");
  }
}

void check(const CharucoBoard& board, const std::string& place) {
  if (board.columns < 3 || board.rows < 3) {
    throw Error(place, "fewer than 3 squares along a side", "count the squares");
  }
  require_few(board.columns, board.rows, place);
  require_length(board.square_m, place, "the side of a square");
  require_length(board.marker_m, place, "the side of a marker");
  if (board.marker_m >= board.square_m) {
    throw Error(place, "its markers are not smaller than its squares",
                "give the side of a square and the smaller one of a marker");
  }
  require_markers(board.columns * board.rows / 2, board.dictionary, place);
}

void check(const AprilTagGrid& grid, const std::string& place) {
  require_few(grid.columns, grid.rows, place);
  if (grid.columns < 1 || grid.rows < 1 || grid.columns * grid.rows < 2) {
    throw Error(place, "fewer than 2 tags", "give the columns and rows of tags");
  }
  require_length(grid.tag_m, place, "the side of a tag");
  if (!(grid.spacing > 0) || !std::isfinite(grid.spacing)) {
    throw Error(place, "the spacing of its tags is not above 0",
                "give the gap between tags divided by the side of a tag");
  }
  if (grid.border_bits < 0 || grid.border_bits > 2) {
    throw Error(place, "its border is " + std::to_string(grid.border_bits) + " bits wide",
                "use 1, or 2 as Kalibr does");
  }
  require_markers(grid.columns * grid.rows, "apriltag_" + grid.family, place);
}

std::vector<Eigen::Vector3d> points(const Chessboard& board) {
  const double row_m = board.row_m > 0 ? board.row_m : board.square_m;
  std::vector<Eigen::Vector3d> all;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      all.emplace_back(column * board.square_m, row * row_m, 0);
    }
  }
  return all;
}

std::vector<Eigen::Vector3d> points(const CharucoBoard& board) {
  return points(Chessboard{board.columns - 1, board.rows - 1, board.square_m});
}

std::vector<Eigen::Vector3d> points(const AprilTagGrid& grid) {
  const auto along = [&](int i) {
    const int tag = i / 2;
    return tag * (1 + grid.spacing) * grid.tag_m + (i % 2) * grid.tag_m;
  };
  std::vector<Eigen::Vector3d> all;
  for (int row = 0; row < 2 * grid.rows; ++row) {
    for (int column = 0; column < 2 * grid.columns; ++column) {
      all.emplace_back(along(column), along(row), 0);
    }
  }
  return all;
}

std::string name(const Chessboard& board) {
  return size_text(board.columns, board.rows) + " board";
}
std::string name(const CharucoBoard& board) {
  return size_text(board.columns, board.rows) + " ChArUco board";
}
std::string name(const AprilTagGrid& grid) {
  return size_text(grid.columns, grid.rows) + " AprilTag grid";
}

Eigen::Vector2i grid_of(const Chessboard& board) { return {board.columns, board.rows}; }
Eigen::Vector2i grid_of(const CharucoBoard& board) { return {board.columns - 1, board.rows - 1}; }
Eigen::Vector2i grid_of(const AprilTagGrid& grid) { return {2 * grid.columns, 2 * grid.rows}; }

}  // namespace

void check_target(const BoardTarget& target) {
  std::visit([&](const auto& board) { check(board, name_of(target)); }, target);
}

std::vector<Eigen::Vector3d> target_points(const BoardTarget& target) {
  return std::visit([](const auto& board) { return points(board); }, target);
}

Eigen::Vector2i corner_grid(const BoardTarget& target) {
  return std::visit([](const auto& board) { return grid_of(board); }, target);
}

std::string name_of(const BoardTarget& target) {
  return std::visit([](const auto& board) { return name(board); }, target);
}

}  // namespace vernier
