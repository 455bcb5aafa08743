// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/chessboard_finder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/board/corner_refinement.h"
#include "calib/board/image_fault.h"
#include "calib/board_detection.h"
#include "calib/board_target.h"

namespace vernier::internal {
namespace {

/// Corners of a grid, row by row, as OpenCV's finders return them.
struct CornerGrid {
  int columns = 0, rows = 0;
  std::vector<cv::Point2f> corners;

  const cv::Point2f& at(int column, int row) const { return corners[row * columns + column]; }
};

/// Mean grey value in the middle of a square given by its corners in order; std::nullopt if it is
/// not completely inside the image.
std::optional<double> brightness(const cv::Mat& grey, const std::array<cv::Point2d, 4>& square) {
  double sum = 0;
  int count = 0;
  for (double s = 0.3; s < 0.75; s += 0.1) {
    for (double t = 0.3; t < 0.75; t += 0.1) {
      const cv::Point2d p = square[0] * (1 - s) * (1 - t) + square[1] * s * (1 - t) +
                            square[2] * s * t + square[3] * (1 - s) * t;
      const int x = cvRound(p.x), y = cvRound(p.y);
      if (x < 0 || y < 0 || x >= grey.cols || y >= grey.rows) return std::nullopt;
      sum += grey.at<unsigned char>(y, x);
      ++count;
    }
  }
  return sum / count;
}

/// A corner of the grid, or its extrapolation beyond the grid by whole or fractional steps, with
/// the second differences along rows and columns at the border kept constant.
cv::Point2d beyond(const CornerGrid& grid, double column, double row) {
  const auto extend = [](auto at, double i, int n) -> cv::Point2d {
    if (i >= 0 && i <= n - 1) return at(static_cast<int>(i));
    const int edge = i < 0 ? 0 : n - 1, in = i < 0 ? 1 : -1;
    const double k = i < 0 ? -i : i - (n - 1);
    const cv::Point2d a = at(edge), b = at(edge + in), c = at(edge + 2 * in);
    return a + k * (a - b) + (0.5 * k * (k + 1)) * (a - 2 * b + c);
  };
  const auto along_row = [&](int r) {
    return extend([&](int c) { return cv::Point2d(grid.at(c, r)); }, column, grid.columns);
  };
  return extend(along_row, row, grid.rows);
}

/// A part of a square, between two positions of the grid.
struct Piece {
  int column, row;  ///< its square's upper left corner; (-1, -1) is the board's first
  double left, top, right, bottom;
};

std::optional<double> brightness(const cv::Mat& grey, const CornerGrid& grid, const Piece& piece) {
  return brightness(
      grey, {beyond(grid, piece.left, piece.top), beyond(grid, piece.right, piece.top),
             beyond(grid, piece.right, piece.bottom), beyond(grid, piece.left, piece.bottom)});
}

Piece whole_square(int column, int row) {
  return {column, row, double(column), double(row), column + 1.0, row + 1.0};
}

/// Mean brightness of the inner squares of either colour; first of those like square (0, 0).
std::array<double, 2> colours(const cv::Mat& grey, const CornerGrid& grid) {
  std::array<double, 2> sum{}, count{};
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int column = 0; column + 1 < grid.columns; ++column) {
      if (const auto value = brightness(grey, grid, whole_square(column, row))) {
        sum[(row + column) % 2] += *value;
        count[(row + column) % 2] += 1;
      }
    }
  }
  return {sum[0] / std::max(count[0], 1.0), sum[1] / std::max(count[1], 1.0)};
}

/// The inner halves of the squares next to the board's outer squares, on its four sides. Outer
/// squares are often narrow, so only the nearer halves are used, without those at the ends.
std::array<std::vector<Piece>, 4> pieces_beyond(const CornerGrid& grid) {
  std::array<std::vector<Piece>, 4> sides;
  for (int c = 0; c + 1 < grid.columns; ++c) {
    sides[0].push_back({c, -2, double(c), -1.5, c + 1.0, -1.0});
    sides[1].push_back({c, grid.rows, double(c), double(grid.rows), c + 1.0, grid.rows + 0.5});
  }
  for (int r = 0; r + 1 < grid.rows; ++r) {
    sides[2].push_back({-2, r, -1.5, double(r), -1.0, r + 1.0});
    sides[3].push_back(
        {grid.columns, r, double(grid.columns), double(r), grid.columns + 0.5, r + 1.0});
  }
  return sides;
}

/// Whether squares of the expected colours continue beyond the board's outer squares on any side.
bool goes_on(const cv::Mat& grey, const CornerGrid& grid) {
  const std::array<double, 2> colour = colours(grey, grid);
  const double middle = 0.5 * (colour[0] + colour[1]);
  const auto follow = [&](const std::vector<Piece>& pieces) {
    int seen = 0, right = 0;
    for (const Piece& piece : pieces) {
      const auto value = brightness(grey, grid, piece);
      if (!value) continue;
      ++seen;
      right += (*value > middle) == (colour[(piece.column + piece.row + 4) % 2] > middle);
    }
    return seen >= 3 && right >= 0.8 * seen;  // a plain margin gets at most two thirds right
  };
  const auto sides = pieces_beyond(grid);
  return std::any_of(sides.begin(), sides.end(), follow);
}

/// Rotates the order by a half turn, if that changes its colour, so that the first square is dark.
void make_order_unique(const cv::Mat& grey, CornerGrid& grid) {
  if ((grid.columns + grid.rows) % 2 == 0) return;
  const auto first = brightness(grey, grid, whole_square(0, 0));
  const auto beside = brightness(grey, grid, whole_square(1, 0));
  if (first && beside && *first > *beside) std::reverse(grid.corners.begin(), grid.corners.end());
}

double smallest_spacing(const CornerGrid& grid) {
  double least = 1e9;
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      if (c + 1 < grid.columns)
        least = std::min(least, cv::norm(grid.at(c, r) - grid.at(c + 1, r)));
      if (r + 1 < grid.rows) least = std::min(least, cv::norm(grid.at(c, r) - grid.at(c, r + 1)));
    }
  }
  return least;
}

/// The largest grid of corners found in the image, at least 3 x 3.
std::optional<CornerGrid> find_any_grid(const cv::Mat& grey) {
  CornerGrid grid;
  cv::Mat meta;
  if (!cv::findChessboardCornersSB(
          grey, {3, 3}, grid.corners,
          cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_LARGER, meta)) {
    return std::nullopt;
  }
  grid.columns = meta.cols;
  grid.rows = meta.rows;
  if (grid.corners.size() != static_cast<std::size_t>(grid.columns) * grid.rows) {
    return std::nullopt;
  }
  return grid;
}

/// Dark specks of an image as findChessboardCorners binarises it: white is where a pixel is
/// brighter than the mean of its neighbourhood, and every dark speck in it may be a square.
int dark_specks(const cv::Mat& grey) {
  constexpr int least_area_px2 = 25;  // of its box, as in OpenCV
  cv::Mat equal, dark, labels, boxes, centres;
  cv::equalizeHist(grey, equal);
  const int block = std::max(3, cvRound(0.2 * std::min(grey.cols, grey.rows)) | 1);
  cv::adaptiveThreshold(equal, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, block,
                        0);
  const int regions = cv::connectedComponentsWithStats(dark, labels, boxes, centres, 4);
  int specks = 0;
  for (int i = 1; i < regions; ++i) {  // 0 is what is white
    specks += boxes.at<int>(i, cv::CC_STAT_WIDTH) * boxes.at<int>(i, cv::CC_STAT_HEIGHT) >=
              least_area_px2;
  }
  return specks;
}

/// The image in which findChessboardCorners is to search.
struct SearchedImage {
  cv::Mat grey;        ///< empty if no smoothing helps
  double blur_px = 0;  ///< standard deviation; 0: the image itself
};

/// The image itself, or where its noise or texture has very many specks, smoothed until it has few.
SearchedImage searched_image(const cv::Mat& grey, const CornerGrid& grid) {
  // The time without a board grows with the square of their number: 1 to 2 s at 1000, 2 to 6 s at
  // 1500, 20 to 60 s at 4000. Smoothing loses squares of less than some 12 px; an image of 480 x
  // 360, where boards have such, has no room for more than 1500 specks.
  constexpr int most_as_it_is = 1500, most_smoothed = 1000;
  const int expected = 2 * (grid.columns + 1) * (grid.rows + 1);
  if (dark_specks(grey) <= std::max(most_as_it_is, expected)) return {grey, 0};
  for (const double blur_px : {0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0}) {
    cv::Mat smooth;
    cv::GaussianBlur(grey, smooth, {0, 0}, blur_px);
    if (dark_specks(smooth) <= std::max(most_smoothed, expected)) return {smooth, blur_px};
  }
  return {};
}

bool find_corners(const cv::Mat& grey, const SearchedImage& searched, CornerGrid& grid) {
  const cv::Size size(grid.columns, grid.rows);
  if (!searched.grey.empty() &&
      cv::findChessboardCorners(searched.grey, size, grid.corners,
                                cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return true;
  }
  return cv::findChessboardCornersSB(grey, size, grid.corners,
                                     cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE);
}

/// How the search was shortened, for the reason; empty if it was not.
std::string search_text(const SearchedImage& searched) {
  if (searched.grey.empty()) {
    return "; its noise or texture is so strong that one of two searches was left out";
  }
  if (searched.blur_px == 0) return "";
  return "; because of its noise or texture one of two searches was in a copy smoothed by " +
         fmt::format("{:.1f} px", searched.blur_px);
}

std::string grid_text(int columns, int rows) {
  return std::to_string(columns) + "x" + std::to_string(rows);
}

/// Whether the squares around the next corners beyond one side of the grid would leave the image.
bool cut_by_border(const cv::Mat& grey, const CornerGrid& grid) {
  constexpr double step = 1.5;  // to the next corner, and half a square around it
  const auto outside = [&](double column, double row) {
    const cv::Point2d p = beyond(grid, column, row);
    return p.x < 0 || p.y < 0 || p.x > grey.cols - 1 || p.y > grey.rows - 1;
  };
  for (int column = 0; column < grid.columns; ++column) {
    if (outside(column, -step) || outside(column, grid.rows - 1 + step)) return true;
  }
  for (int row = 0; row < grid.rows; ++row) {
    if (outside(-step, row) || outside(grid.columns - 1 + step, row)) return true;
  }
  return false;
}

std::string bigger(const Chessboard& board) {
  return "the board seems to have more inner corners than " + grid_text(board.columns, board.rows);
}

/// The reason why no board of this size was found, from what was found instead.
std::string fault_of(const cv::Mat& grey, const Chessboard& board, BoardDetection& result) {
  std::string reason = "no " + grid_text(board.columns, board.rows) + " board found";
  if (const auto grid = find_any_grid(grey)) {
    const auto [least, most] = std::minmax(grid->columns, grid->rows);
    const auto [short_side, long_side] = std::minmax(board.columns, board.rows);
    const std::string seen = grid_text(grid->columns, grid->rows);
    if (least >= short_side && most >= long_side) {
      result.goes_on = true;
      return reason + "; " + bigger(board) + ": " + seen + " are seen";
    }
    reason += "; only " + seen + " of its corners were found";
    // A few corners may belong to something else, those of a grid larger than 3x4 do not.
    if (grid->columns * grid->rows > std::max(12, board.columns * board.rows / 4)) {
      reason += cut_by_border(grey, *grid) ? ", the board is cut off by the image's border"
                                           : ", the others are occluded or the board has fewer";
    }
    const double spacing = smallest_spacing(*grid);
    if (spacing < 10) reason += ", and they are only " + std::to_string(int(spacing)) + " px apart";
  }
  const std::string fault = image_fault(grey);
  return fault.empty() ? reason : reason + "; " + fault;
}

}  // namespace

void detect_chessboard(const cv::Mat& grey, const Chessboard& board, BoardDetection& result) {
  CornerGrid grid{board.columns, board.rows, {}};
  const SearchedImage searched = searched_image(grey, grid);
  if (!find_corners(grey, searched, grid)) {
    result.reason = fault_of(grey, board, result) + search_text(searched);
    return;
  }
  if (goes_on(grey, grid)) {
    result.goes_on = true;
    result.reason = bigger(board);
    return;
  }
  make_order_unique(grey, grid);
  const int half = std::clamp(static_cast<int>(0.35 * smallest_spacing(grid)), 2, 11);
  std::vector<CornerGuess> guesses;
  for (std::size_t i = 0; i < grid.corners.size(); ++i) {
    guesses.push_back({static_cast<int>(i), {grid.corners[i].x, grid.corners[i].y}, half});
  }
  refine_corners(grey, std::move(guesses), target_points(board), CornerKind::crossing, result);
  const auto astray = std::count_if(
      result.rejected_corners.begin(), result.rejected_corners.end(),
      [](const RejectedCorner& corner) { return corner.why != CornerRejection::at_border; });
  // The finders find whole boards only: several wrong corners mean a board of another size.
  const bool wrong = 10 * astray > static_cast<long>(grid.corners.size());
  if (!wrong && 2 * result.ids.size() >= grid.corners.size()) return;
  const std::string fault = image_fault(grey);
  result.reason = "a " + grid_text(board.columns, board.rows) +
                  " board does not fit: " + rejected_corners_text(result) +
                  (fault.empty() ? "" : "; " + fault);
  result.ids.clear();
  result.corners_px.clear();
}

}  // namespace vernier::internal
