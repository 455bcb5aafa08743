// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/marker_board.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/board/corner_refinement.h"
#include "calib/board/image_fault.h"
#include "calib/board/marker_dictionary.h"
#include "calib/board/marker_layout.h"
#include "calib/board/plane_homography.h"
#include "calib/board_detection.h"
#include "calib/board_observations.h"
#include "calib/board_target.h"

namespace vernier::internal {
namespace {

constexpr std::size_t min_corners = 6;

/// The largest window that contains nothing but the corner: `free_m` is the distance to the next
/// edge of the pattern.
int window_at(const Eigen::Matrix2d& px_per_m, double free_m) {
  const Eigen::Vector2d stretch = Eigen::JacobiSVD<Eigen::Matrix2d>(px_per_m).singularValues();
  return std::clamp(static_cast<int>(std::floor(0.9 * free_m * stretch[1] - 0.5)), 2, 11);
}

/// Whether the corners span the plane: not all within a tenth of their extent from a line.
bool span_plane(const std::vector<int>& ids, const std::vector<Eigen::Vector3d>& target_m) {
  Eigen::MatrixX2d x(ids.size(), 2);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    x.row(static_cast<Eigen::Index>(i)) = target_m[ids[i]].head<2>().transpose();
  }
  x.rowwise() -= x.colwise().mean().eval();
  const Eigen::Matrix2d scatter = x.transpose() * x;
  const Eigen::Vector2d s = Eigen::JacobiSVD<Eigen::Matrix2d>(scatter).singularValues();
  return s[1] > 0.01 * s[0];  // of squares
}

/// Rejects all corners if there are too few.
void reject_too_few(const std::vector<Eigen::Vector3d>& target_m,
                    const std::string& name,
                    BoardDetection& result) {
  const std::size_t corners = result.ids.size();
  if (corners < min_corners) {
    result.reason = "only " + std::to_string(corners) + " good corners of the " + name +
                    ", at least " + std::to_string(min_corners) + " are needed";
    if (!result.rejected_corners.empty())
      result.reason += "; not used: " + rejected_corners_text(result);
  } else if (!span_plane(result.ids, target_m) || !determines_pose(target_m, result.ids)) {
    result.reason = "all good corners of the " + name + ", or all but one, are collinear";
  } else {
    return;
  }
  result.ids.clear();
  result.corners_px.clear();
}

/// The reason why no usable markers were found.
std::string marker_fault(const cv::Mat& grey,
                         const DetectedMarkers& seen,
                         const MarkerLayout& layout,
                         const std::string& name) {
  std::string reason = "no " + name + " found";
  if (seen.repeated > 0) {
    reason += "; " + std::to_string(seen.repeated) + " markers appear more than once";
  }
  if (!seen.foreign.empty()) {
    reason +=
        "; " + std::to_string(seen.foreign.size()) + " markers have ids that are not on this board";
  }
  if (seen.markers.size() == 1) {
    reason += "; only marker " + std::to_string(seen.markers[0].id) + " of " +
              std::to_string(layout.corners_m.size()) + " is seen";
  } else if (seen.markers.empty() && seen.undecoded > 0) {
    reason += "; " + std::to_string(seen.undecoded) + " quadrilaterals, none with a pattern of " +
              layout.dictionary;
  }
  const std::string fault = image_fault(grey);
  return fault.empty() ? reason : reason + "; " + fault;
}

/// A board commonly mistaken for another, and the remedy.
struct Mistake {
  std::vector<MarkerLayout> layouts;
  std::string remedy;
};

/// The layout that most markers are consistent with, and these markers.
std::pair<std::size_t, std::vector<DetectedMarker>> best_layout(
    const std::vector<DetectedMarker>& markers, const std::vector<MarkerLayout>& layouts) {
  std::pair<std::size_t, std::vector<DetectedMarker>> best;
  for (std::size_t i = 0; i < layouts.size(); ++i) {
    auto good = consistent_markers(markers, layouts[i]);
    if (good.size() > best.second.size()) best = {i, std::move(good)};
  }
  return best;
}

struct FoundLayout {
  MarkerLayout layout;
  DetectedMarkers seen;
};

/// The markers that match one of the layouts; std::nullopt, with the reason in `result`, for fewer
/// than two.
std::optional<FoundLayout> find_layout(const cv::Mat& grey,
                                       const std::vector<MarkerLayout>& layouts,
                                       const std::vector<Mistake>& mistakes,
                                       const std::string& name,
                                       BoardDetection& result) {
  DetectedMarkers seen = find_markers(grey, layouts[0]);
  if (seen.markers.size() < 2) {
    result.reason = marker_fault(grey, seen, layouts[0], name);
    return std::nullopt;
  }
  auto [index, good] = best_layout(seen.markers, layouts);
  std::size_t most = good.size();
  std::string remedy = most < 2 ? "check its size" : "";
  for (const Mistake& mistake : mistakes) {
    const std::size_t count = best_layout(seen.markers, mistake.layouts).second.size();
    if (count <= most) continue;
    most = count;
    remedy = mistake.remedy;
  }
  if (!remedy.empty()) {
    result.reason = std::to_string(seen.markers.size()) +
                    " markers are seen, but their arrangement does not match the " + name + "; " +
                    remedy;
    return std::nullopt;
  }
  seen.markers = std::move(good);
  return FoundLayout{layouts[index], std::move(seen)};
}

/// A tag may be printed at any quarter turn, which is determined from its neighbours.
std::vector<MarkerLayout> turned_layouts(const AprilTagGrid& grid) {
  std::vector<MarkerLayout> layouts;
  layouts.reserve(4);
  for (int turns = 0; turns < 4; ++turns) layouts.push_back(layout_of(grid, turns));
  return layouts;
}

template <class Board>
Board swapped(Board board) {
  std::swap(board.columns, board.rows);
  return board;
}

template <class Board>
std::string swap_remedy(const Board& board) {
  return "they match a board of " + std::to_string(board.rows) + "x" +
         std::to_string(board.columns) + ": swap the columns and rows";
}

std::vector<Mistake> mistakes_for(const CharucoBoard& board) {
  std::vector<Mistake> mistakes;
  if (board.rows % 2 == 0) {
    CharucoBoard other = board;
    other.legacy = !board.legacy;
    Mistake& mistake = mistakes.emplace_back();
    mistake.layouts = {layout_of(other)};
    mistake.remedy = board.legacy
                         ? "they match the layout of OpenCV 4.6 and later: leave out --legacy"
                         : "they match the layout of OpenCV before 4.6: give --legacy";
  }
  mistakes.push_back({{layout_of(swapped(board))}, swap_remedy(board)});
  return mistakes;
}

/// A grid of more columns or fewer, with rows enough for the same tags.
AprilTagGrid wider(AprilTagGrid grid, int columns) {
  const int tags = grid.columns * grid.rows;
  grid.columns = std::max(1, grid.columns + columns);
  grid.rows = std::max(grid.rows, (tags + grid.columns - 1) / grid.columns);
  return grid;
}

std::string count_remedy(const AprilTagGrid& grid) {
  return "they match a board of " + std::to_string(grid.columns) + " columns: count them again";
}

std::vector<Mistake> mistakes_for(const AprilTagGrid& grid) {
  AprilTagGrid other = grid;
  other.top_row_first = !grid.top_row_first;
  return {{turned_layouts(other),
           grid.top_row_first ? "they are numbered from the bottom row: leave out --top-row-first"
                              : "they are numbered from the top row: give --top-row-first"},
          {turned_layouts(swapped(grid)), swap_remedy(grid)},
          {turned_layouts(wider(grid, 1)), count_remedy(wider(grid, 1))},
          {turned_layouts(wider(grid, -1)), count_remedy(wider(grid, -1))}};
}

/// Ids beyond the grid's, of tags that are where a grid of more rows has them: tags elsewhere in
/// the scene are not.
std::vector<int> ids_beyond(const AprilTagGrid& grid, const DetectedMarkers& seen) {
  std::vector<DetectedMarker> all = seen.markers;
  const int own = grid.columns * grid.rows;
  for (const DetectedMarker& marker : seen.foreign) {
    const auto same = [&](const DetectedMarker& other) { return other.id == marker.id; };
    if (std::count_if(seen.foreign.begin(), seen.foreign.end(), same) == 1) all.push_back(marker);
  }
  if (all.size() == seen.markers.size()) return {};
  std::sort(all.begin(), all.end(),
            [](const DetectedMarker& a, const DetectedMarker& b) { return a.id < b.id; });
  AprilTagGrid higher = grid;
  higher.rows = all.back().id / grid.columns + 1;
  std::vector<int> ids;
  for (const DetectedMarker& marker : best_layout(all, turned_layouts(higher)).second) {
    if (marker.id >= own) ids.push_back(marker.id);
  }
  return ids;
}

/// The four corners of a tag as points of the grid.
std::array<int, 4> corners_of(const AprilTagGrid& grid, int tag) {
  const int counted = tag / grid.columns;
  const int row = grid.top_row_first ? grid.rows - 1 - counted : counted;
  const int first = 4 * grid.columns * row + 2 * (tag % grid.columns);
  return {first, first + 1, first + 2 * grid.columns, first + 2 * grid.columns + 1};
}

/// The corner of a marker that is nearest to a point of the board, as detected: within half the
/// side of the squares between the tags, which touch its corners.
Eigen::Vector2d seen_corner(const DetectedMarker& marker,
                            const MarkerLayout& layout,
                            const Eigen::Vector2d& point_m) {
  const MarkerCorners& corners_m = layout.corners_m[marker.id];
  const auto nearest = std::min_element(
      corners_m.begin(), corners_m.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return (a - point_m).squaredNorm() < (b - point_m).squaredNorm();
      });
  return marker.corners_px[nearest - corners_m.begin()];
}

std::vector<Eigen::Vector2d> plane_points(const std::vector<Eigen::Vector3d>& target_m) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(target_m.size());
  for (const auto& X : target_m) points.push_back(X.head<2>());
  return points;
}

}  // namespace

void detect_marker_board(const cv::Mat& grey, const CharucoBoard& board, BoardDetection& result) {
  const std::string name = name_of(board);
  const auto found = find_layout(grey, {layout_of(board)}, mistakes_for(board), name, result);
  if (!found) return;
  const std::vector<DetectedMarker>& markers = found->seen.markers;
  const double free_m = std::min(0.5 * (board.square_m - board.marker_m), 0.35 * board.square_m);
  const auto target_m = target_points(board);
  const auto points = plane_points(target_m);
  std::vector<CornerGuess> guesses;
  for (int id = 0; id < static_cast<int>(points.size()); ++id) {
    const auto near = [&](std::size_t count, double squares) {
      return homography_near(markers, found->layout, points[id], count, squares * board.square_m);
    };
    if (!near(1, 0.8)) continue;  // neither adjacent marker was detected
    const auto H = near(4, 1.7);
    if (!H) continue;
    guesses.push_back(
        {id, map_point(*H, points[id]), window_at(map_derivative(*H, points[id]), free_m)});
  }
  refine_corners(grey, std::move(guesses), target_m, CornerKind::crossing, result);
  reject_too_few(target_m, name, result);
}

void detect_marker_board(const cv::Mat& grey, const AprilTagGrid& grid, BoardDetection& result) {
  const std::string name = name_of(grid);
  auto found = find_layout(grey, turned_layouts(grid), mistakes_for(grid), name, result);
  if (!found) return;
  result.ids_beyond = ids_beyond(grid, found->seen);
  add_missed_markers(grey, found->layout, found->seen);
  const int border = found->seen.border_bits;
  const int cells = marker_dictionary(found->layout.dictionary)->markerSize + 2 * border;
  const double free_m =
      grid.tag_m * std::min(double(border) / cells, grid.spacing / std::numbers::sqrt2);
  // Its own tag and those around it: they determine the six powers of the map in both directions,
  // and reach little further than a pitch and a half, where these describe what a lens does.
  constexpr std::size_t around = 9;
  const double reach_m = 0.5 * grid.spacing * grid.tag_m;  // half way to the next crossing
  const auto target_m = target_points(grid);
  const auto points = plane_points(target_m);
  std::vector<CornerGuess> guesses;
  for (const DetectedMarker& marker : found->seen.markers) {
    for (const int id : corners_of(grid, marker.id)) {
      const auto map = bent_map_near(found->seen.markers, found->layout, points[id], around,
                                     2.3 * found->layout.pitch_m);
      if (!map) continue;
      const Eigen::Vector2d own_px = seen_corner(marker, found->layout, points[id]);
      const double apart_m = (map->px_per_m.inverse() * (map->pixel_px - own_px)).norm();
      guesses.push_back({id, apart_m > reach_m ? own_px : map->pixel_px,
                         window_at(map->px_per_m, free_m), reach_m, map->px_per_m});
    }
  }
  refine_corners(grey, std::move(guesses), target_m, CornerKind::as_most, result);
  reject_too_few(target_m, name, result);
}

}  // namespace vernier::internal
