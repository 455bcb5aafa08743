// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/board_target.h"

namespace vernier::internal {

/// The corners of a marker clockwise from the one that OpenCV's own drawing has in the upper left.
using MarkerCorners = std::array<Eigen::Vector2d, 4>;

/// Where the markers of a board are on it, by their number.
struct MarkerLayout {
  std::string dictionary;
  std::vector<int> border_bits;  ///< to be tried in turn
  double pitch_m = 0;            ///< from marker to marker
  std::vector<MarkerCorners> corners_m;
};

MarkerLayout layout_of(const CharucoBoard& board);

/// Tags as they stand on Kalibr's sheets, which is half a turn from OpenCV's drawings of them, and
/// turned further by `quarter_turns`.
MarkerLayout layout_of(const AprilTagGrid& grid, int quarter_turns = 0);

struct DetectedMarker {
  int id = 0;
  MarkerCorners corners_px;
};

struct DetectedMarkers {
  std::vector<DetectedMarker> markers;  ///< ascending by id, each id once
  int border_bits = 1;
  int repeated = 0;   ///< ids left out because they were seen more than once
  int foreign = 0;    ///< ids left out because the board has none such
  int undecoded = 0;  ///< outlines of four sides without a known pattern
};

/// All markers of the layout's dictionary, at whichever border shows more of them.
DetectedMarkers find_markers(const cv::Mat& grey, const MarkerLayout& layout);

/// The markers at least half of whose up to four nearest neighbours lie where the layout has them.
std::vector<DetectedMarker> consistent_markers(const std::vector<DetectedMarker>& markers,
                                               const MarkerLayout& layout);

/// Adds markers of the layout that the detector missed (the squares between Kalibr's tags run into
/// their outlines): predicted from those around, and taken where their pattern is read there.
void add_missed_markers(const cv::Mat& grey, const MarkerLayout& layout, DetectedMarkers& seen);

/// The homography of the up to `count` markers nearest to a point of the board, all within
/// `reach_m`; nothing where there is none.
std::optional<Eigen::Matrix3d> homography_near(const std::vector<DetectedMarker>& markers,
                                               const MarkerLayout& layout,
                                               const Eigen::Vector2d& point_m,
                                               std::size_t count,
                                               double reach_m);

}  // namespace vernier::internal
