// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/marker_layout.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "calib/base/decompositions.h"
#include "calib/board/marker_dictionary.h"
#include "calib/board/plane_homography.h"
#include "calib/board_target.h"

namespace vernier::internal {
namespace {

constexpr double min_side_px = 10;  // smaller patterns cannot be read

Eigen::Vector2d centre(const MarkerCorners& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

cv::Ptr<cv::aruco::DetectorParameters> parameters(const cv::Mat& grey, int border_bits) {
  const auto p = cv::aruco::DetectorParameters::create();
  p->markerBorderBits = border_bits;
  p->minDistanceToBorder = 1;
  p->adaptiveThreshWinSizeMax = std::clamp(std::min(grey.cols, grey.rows) / 12, 23, 63);
  p->minMarkerPerimeterRate =
      std::min(p->minMarkerPerimeterRate, 4 * min_side_px / std::max(grey.cols, grey.rows));
  return p;
}

DetectedMarkers find_at(const cv::Mat& grey, const MarkerLayout& layout, int border_bits) {
  std::vector<std::vector<cv::Point2f>> corners, rejected;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, marker_dictionary(layout.dictionary), corners, ids,
                           parameters(grey, border_bits), rejected);
  DetectedMarkers seen;
  seen.border_bits = border_bits;
  seen.undecoded = static_cast<int>(rejected.size());
  std::map<int, int> count;
  for (const int id : ids) ++count[id];
  for (std::size_t i = 0; i < ids.size(); ++i) {
    DetectedMarker marker{ids[i], {}};
    for (int k = 0; k < 4; ++k) marker.corners_px[k] = {corners[i][k].x, corners[i][k].y};
    if (ids[i] >= static_cast<int>(layout.corners_m.size())) {
      seen.foreign.push_back(marker);
    } else if (count[ids[i]] > 1) {
      ++seen.repeated;
    } else {
      seen.markers.push_back(marker);
    }
  }
  std::sort(seen.markers.begin(), seen.markers.end(),
            [](const DetectedMarker& a, const DetectedMarker& b) { return a.id < b.id; });
  return seen;
}

/// Markers sorted by their distance on the board from a point.
std::vector<std::pair<double, const DetectedMarker*>> by_distance(
    const std::vector<DetectedMarker>& markers,
    const MarkerLayout& layout,
    const Eigen::Vector2d& from) {
  std::vector<std::pair<double, const DetectedMarker*>> sorted;
  sorted.reserve(markers.size());
  for (const DetectedMarker& marker : markers) {
    sorted.emplace_back((centre(layout.corners_m[marker.id]) - from).norm(), &marker);
  }
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

struct PointPairs {
  std::vector<Eigen::Vector2d> from_m, to_px;
};

/// The corners of the up to `count` markers nearest to a point of the board, within `reach_m`.
PointPairs corners_near(const std::vector<DetectedMarker>& markers,
                        const MarkerLayout& layout,
                        const Eigen::Vector2d& point_m,
                        std::size_t count,
                        double reach_m) {
  PointPairs near;
  for (const auto& [distance, marker] : by_distance(markers, layout, point_m)) {
    if (near.from_m.size() >= 4 * count || distance > reach_m) break;
    for (int k = 0; k < 4; ++k) {
      near.from_m.push_back(layout.corners_m[marker->id][k]);
      near.to_px.push_back(marker->corners_px[k]);
    }
  }
  return near;
}

/// Whether b is where a predicts it.
bool agree(const DetectedMarker& a, const DetectedMarker& b, const MarkerLayout& layout) {
  const auto& am = layout.corners_m[a.id];
  const auto& bm = layout.corners_m[b.id];
  const auto H = fit_homography({am.begin(), am.end()}, {a.corners_px.begin(), a.corners_px.end()});
  if (!H) return false;
  constexpr double tolerable = 0.35;  // of a side of b, per side of distance
  double side = 0, worst = 0;
  for (int k = 0; k < 4; ++k) {
    side += 0.25 * (b.corners_px[k] - b.corners_px[(k + 1) % 4]).norm();
    worst = std::max(worst, (map_point(*H, bm[k]) - b.corners_px[k]).norm());
  }
  const double apart = (centre(bm) - centre(am)).norm() / (am[0] - am[1]).norm();
  return worst < tolerable * side * std::max(1.0, apart);
}

/// Grey value of each cell's middle, border included, row by row from the marker's upper left.
std::vector<double> read_cells(const cv::Mat& grey, const MarkerCorners& corners_px, int cells) {
  const double n = cells;
  const auto H =
      fit_homography({{0, 0}, {n, 0}, {n, n}, {0, n}}, {corners_px.begin(), corners_px.end()});
  std::vector<double> values;
  for (int row = 0; H && row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      double sum = 0;
      for (const double dy : {0.35, 0.5, 0.65}) {
        for (const double dx : {0.35, 0.5, 0.65}) {
          const Eigen::Vector2d p = map_point(*H, {column + dx, row + dy});
          sum += grey.at<unsigned char>(
              std::clamp(static_cast<int>(std::lround(p.y())), 0, grey.rows - 1),
              std::clamp(static_cast<int>(std::lround(p.x())), 0, grey.cols - 1));
        }
      }
      values.push_back(sum / 9);
    }
  }
  return values;
}

/// Whether the pattern of marker `id` is found at these corners.
bool reads_as(const cv::Mat& grey,
              const cv::aruco::Dictionary& dictionary,
              const DetectedMarker& marker,
              int border_bits) {
  const int bits = dictionary.markerSize, cells = bits + 2 * border_bits;
  const std::vector<double> values = read_cells(grey, marker.corners_px, cells);
  if (values.empty()) return false;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  constexpr double min_contrast = 20;
  if (*high - *low < min_contrast) return false;
  const cv::Mat pattern =
      cv::aruco::Dictionary::getBitsFromByteList(dictionary.bytesList.row(marker.id), bits);
  int wrong = 0, wrong_border = 0;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const bool white = values[row * cells + column] > 0.5 * (*low + *high);
      const int r = row - border_bits, c = column - border_bits;
      const bool inside = r >= 0 && r < bits && c >= 0 && c < bits;
      if (inside) {
        wrong += white != (pattern.at<unsigned char>(r, c) != 0);
      } else {
        wrong_border += white;
      }
    }
  }
  return wrong <= dictionary.maxCorrectionBits / 2 && wrong_border <= cells / 4;
}

bool inside(const cv::Mat& grey, const MarkerCorners& corners) {
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& p) {
    return p.x() >= 0 && p.y() >= 0 && p.x() <= grey.cols - 1 && p.y() <= grey.rows - 1;
  });
}

/// The corners refined in the image, in windows of a tenth of the marker.
MarkerCorners refined(const cv::Mat& grey, const MarkerCorners& corners) {
  double side = 1e9;
  std::vector<cv::Point2f> points;
  for (int k = 0; k < 4; ++k) {
    side = std::min(side, (corners[k] - corners[(k + 1) % 4]).norm());
    points.emplace_back(float(corners[k].x()), float(corners[k].y()));
  }
  const int half = std::clamp(static_cast<int>(0.1 * side), 2, 8);
  cv::cornerSubPix(grey, points, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 1e-2});
  MarkerCorners moved;
  for (int k = 0; k < 4; ++k) moved[k] = {points[k].x, points[k].y};
  return moved;
}

/// Marker `id` at the position predicted by its nearest detected neighbours, if its pattern is
/// found there.
std::optional<DetectedMarker> read_at_prediction(const cv::Mat& grey,
                                                 const cv::aruco::Dictionary& dictionary,
                                                 const MarkerLayout& layout,
                                                 const DetectedMarkers& seen,
                                                 int id) {
  for (const std::size_t count : {3u, 6u}) {
    const auto H = homography_near(seen.markers, layout, centre(layout.corners_m[id]), count,
                                   2.3 * layout.pitch_m);
    if (!H) return std::nullopt;
    DetectedMarker marker{id, {}};
    for (int k = 0; k < 4; ++k) marker.corners_px[k] = map_point(*H, layout.corners_m[id][k]);
    for (int attempt = 0; attempt < 2 && inside(grey, marker.corners_px); ++attempt) {
      if (reads_as(grey, dictionary, marker, seen.border_bits)) return marker;
      marker.corners_px = refined(grey, marker.corners_px);
    }
  }
  return std::nullopt;
}

}  // namespace

MarkerLayout layout_of(const CharucoBoard& board) {
  MarkerLayout layout{board.dictionary, {1}, board.square_m, {}};
  const double gap = 0.5 * (board.square_m - board.marker_m), side = board.marker_m;
  const int shift = board.legacy && board.rows % 2 == 0 ? 1 : 0;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      if ((row + column + shift) % 2 == 0) continue;  // a black square
      // The first inner corner, where squares (0, 0) and (1, 1) meet, is the origin.
      const double x = (column - 1) * board.square_m + gap, y = (row - 1) * board.square_m + gap;
      layout.corners_m.push_back({{{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}}});
    }
  }
  return layout;
}

MarkerLayout layout_of(const AprilTagGrid& grid, int quarter_turns) {
  MarkerLayout layout{"apriltag_" + grid.family, {grid.border_bits}, 0, {}};
  if (grid.border_bits == 0) layout.border_bits = {2, 1};
  layout.pitch_m = (1 + grid.spacing) * grid.tag_m;
  for (int i = 0; i < grid.rows; ++i) {
    const int row = grid.top_row_first ? grid.rows - 1 - i : i;
    for (int column = 0; column < grid.columns; ++column) {
      const double x = column * layout.pitch_m, y = row * layout.pitch_m, side = grid.tag_m;
      // Clockwise from the lower right, which is the upper left of OpenCV's drawing of the tag.
      MarkerCorners corners{{{x + side, y}, {x, y}, {x, y + side}, {x + side, y + side}}};
      std::rotate(corners.begin(), corners.begin() + quarter_turns, corners.end());
      layout.corners_m.push_back(corners);
    }
  }
  return layout;
}

DetectedMarkers find_markers(const cv::Mat& grey, const MarkerLayout& layout) {
  DetectedMarkers best;
  for (const int border_bits : layout.border_bits) {
    DetectedMarkers seen = find_at(grey, layout, border_bits);
    if (best.markers.empty() || seen.markers.size() > best.markers.size()) best = std::move(seen);
  }
  return best;
}

std::vector<DetectedMarker> consistent_markers(const std::vector<DetectedMarker>& markers,
                                               const MarkerLayout& layout) {
  constexpr std::size_t asked = 4;
  std::vector<DetectedMarker> good;
  for (const DetectedMarker& marker : markers) {
    const auto near = by_distance(markers, layout, centre(layout.corners_m[marker.id]));
    const std::size_t count = std::min(asked, near.size() - 1);
    std::size_t agreeing = 0;
    for (std::size_t k = 1; k <= count; ++k) {
      agreeing += agree(*near[k].second, marker, layout) && agree(marker, *near[k].second, layout);
    }
    if (count > 0 && 2 * agreeing >= count) good.push_back(marker);
  }
  return good;
}

std::optional<Eigen::Matrix3d> homography_near(const std::vector<DetectedMarker>& markers,
                                               const MarkerLayout& layout,
                                               const Eigen::Vector2d& point_m,
                                               std::size_t count,
                                               double reach_m) {
  const PointPairs near = corners_near(markers, layout, point_m, count, reach_m);
  return fit_homography(near.from_m, near.to_px);
}

std::optional<LocalMap> bent_map_near(const std::vector<DetectedMarker>& markers,
                                      const MarkerLayout& layout,
                                      const Eigen::Vector2d& point_m,
                                      std::size_t count,
                                      double reach_m) {
  const PointPairs near = corners_near(markers, layout, point_m, count, reach_m);
  const auto H = fit_homography(near.from_m, near.to_px);
  if (!H) return std::nullopt;
  // Residuals as a polynomial of the offset from the point, in units of the pitch.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6), b = Eigen::MatrixXd::Zero(6, 2);
  for (std::size_t i = 0; i < near.from_m.size(); ++i) {
    const Eigen::Vector2d d = (near.from_m[i] - point_m) / layout.pitch_m;
    Eigen::Matrix<double, 6, 1> powers;
    powers << 1, d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y();
    // Half at 0.8 of the pitch, 0.02 at two: what decides is the board around the point, since a
    // lens bends more than these powers tell further away.
    const double weight = std::exp(-d.squaredNorm());
    A += weight * powers * powers.transpose();
    b += weight * powers * (near.to_px[i] - map_point(*H, near.from_m[i])).transpose();
  }
  // Markers in one row do not determine all powers: those stay 0. Far below the eigenvalues of the
  // others, of some hundredths of the trace, so that it takes nothing from these.
  constexpr double ridge = 1e-4;
  A.diagonal().array() += ridge * A.trace();
  const Eigen::MatrixXd bend = Cholesky(A).solve(b);
  return LocalMap{map_point(*H, point_m) + bend.row(0).transpose(),
                  map_derivative(*H, point_m) + bend.middleRows(1, 2).transpose() / layout.pitch_m};
}

void add_missed_markers(const cv::Mat& grey, const MarkerLayout& layout, DetectedMarkers& seen) {
  const auto dictionary = marker_dictionary(layout.dictionary);
  std::vector<bool> have(layout.corners_m.size(), false);
  for (const DetectedMarker& marker : seen.markers) have[marker.id] = true;
  for (bool grown = true; grown;) {
    grown = false;
    for (int id = 0; id < static_cast<int>(have.size()); ++id) {
      if (have[id]) continue;
      const auto marker = read_at_prediction(grey, *dictionary, layout, seen, id);
      if (!marker) continue;
      seen.markers.push_back(*marker);
      have[id] = grown = true;
    }
  }
  std::sort(seen.markers.begin(), seen.markers.end(),
            [](const DetectedMarker& a, const DetectedMarker& b) { return a.id < b.id; });
}

}  // namespace vernier::internal
