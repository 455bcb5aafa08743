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

/// The positions of the markers on a board, by id.
struct MarkerLayout {
  std::string dictionary;
  std::vector<int> border_bits;  ///< tried in turn
  double pitch_m = 0;            ///< from marker to marker
  std::vector<MarkerCorners> corners_m;
};

MarkerLayout layout_of(const CharucoBoard& board);

/// Tags as on Kalibr's sheets, rotated by half a turn from OpenCV's drawings, and by further
/// `quarter_turns`.
MarkerLayout layout_of(const AprilTagGrid& grid, int quarter_turns = 0);

struct DetectedMarker {
  int id = 0;
  MarkerCorners corners_px;
};

struct DetectedMarkers {
  std::vector<DetectedMarker> markers;  ///< ascending by id, each id once
  int border_bits = 1;
  int repeated = 0;                     ///< ids ignored because they were detected more than once
  std::vector<DetectedMarker> foreign;  ///< with ids that are not on the board
  int undecoded = 0;                    ///< quadrilaterals without a known pattern
};

/// All markers of the layout's dictionary, with the border width that yields more of them.
DetectedMarkers find_markers(const cv::Mat& grey, const MarkerLayout& layout);

/// The markers for which at least half of the up to four nearest neighbours are consistent with the
/// layout.
std::vector<DetectedMarker> consistent_markers(const std::vector<DetectedMarker>& markers,
                                               const MarkerLayout& layout);

/// Adds markers of the layout that the detector missed (the squares between Kalibr's tags touch
/// their outlines): predicted from their neighbours, and accepted if the pattern is found there.
void add_missed_markers(const cv::Mat& grey, const MarkerLayout& layout, DetectedMarkers& seen);

/// The homography of the up to `count` markers nearest to a point of the board, within `reach_m`;
/// std::nullopt if it cannot be determined.
std::optional<Eigen::Matrix3d> homography_near(const std::vector<DetectedMarker>& markers,
                                               const MarkerLayout& layout,
                                               const Eigen::Vector2d& point_m,
                                               std::size_t count,
                                               double reach_m);

/// The image of a point of the board and the derivative there.
struct LocalMap {
  Eigen::Vector2d pixel_px;
  Eigen::Matrix2d px_per_m;
};

/// As homography_near, with what lens distortion adds to the homography: a polynomial of second
/// degree, fitted to the markers' residuals. Over nine tags a wide lens bends a homography by
/// more than the squares between the tags.
std::optional<LocalMap> bent_map_near(const std::vector<DetectedMarker>& markers,
                                      const MarkerLayout& layout,
                                      const Eigen::Vector2d& point_m,
                                      std::size_t count,
                                      double reach_m);

}  // namespace vernier::internal
