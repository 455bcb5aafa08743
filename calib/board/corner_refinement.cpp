// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/board/corner_refinement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>

#include "calib/board/plane_homography.h"
#include "calib/board_detection.h"

namespace vernier::internal {
namespace {

constexpr int min_half_window = 2;
constexpr double always_within_px = 1;  // of small boards, whose guesses are no better
constexpr double min_contrast = 12;     // grey values in a corner's window
constexpr double max_asymmetry = 0.3;   // of that contrast
constexpr std::size_t neighbours = 12;
constexpr std::size_t min_neighbours = 8;

double grey_at(const cv::Mat& grey, const Eigen::Vector2d& p) {
  const int x = std::clamp(static_cast<int>(std::floor(p.x())), 0, grey.cols - 2);
  const int y = std::clamp(static_cast<int>(std::floor(p.y())), 0, grey.rows - 2);
  const double s = p.x() - x, t = p.y() - y;
  const auto* top = grey.ptr<unsigned char>(y);
  const auto* below = grey.ptr<unsigned char>(y + 1);
  return (1 - t) * ((1 - s) * top[x] + s * top[x + 1]) +
         t * ((1 - s) * below[x] + s * below[x + 1]);
}

/// A crossing of squares is symmetric under a half turn: compares opposite points on a circle.
bool is_crossing(const cv::Mat& grey, const Eigen::Vector2d& corner, double radius) {
  constexpr int points = 24;  // on half of the circle
  double difference = 0, low = 255, high = 0;
  for (int i = 0; i < points; ++i) {
    const double angle = std::numbers::pi * i / points;
    const Eigen::Vector2d d = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const double a = grey_at(grey, corner + d), b = grey_at(grey, corner - d);
    difference += std::abs(a - b);
    low = std::min({low, a, b});
    high = std::max({high, a, b});
  }
  return high - low > min_contrast && difference / points < max_asymmetry * (high - low);
}

/// cornerSubPix for one corner. OpenCV resets a corner that left its window to its start, so one
/// that did not move is tried again from a displaced start: std::nullopt if it does not move then
/// either.
std::optional<Eigen::Vector2d> refine_once(const cv::Mat& grey,
                                           const Eigen::Vector2d& from,
                                           int half) {
  for (const float nudge : {0.0f, 0.03f}) {
    const cv::Point2f start(float(from.x()) + nudge, float(from.y()) - nudge);
    std::vector<cv::Point2f> corner{start};
    cv::cornerSubPix(grey, corner, {half, half}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
    if (corner[0] != start) return Eigen::Vector2d(corner[0].x, corner[0].y);
  }
  return std::nullopt;
}

/// The refined position and its window, or the reason for a rejection.
std::optional<CornerRejection> refine(const cv::Mat& grey, CornerGuess& guess) {
  const Eigen::Vector2d far(grey.cols - 1 - guess.pixel_px.x(), grey.rows - 1 - guess.pixel_px.y());
  const double room = std::min(guess.pixel_px.minCoeff(), far.minCoeff()) - 1;
  const int half = std::min(guess.half_window_px, static_cast<int>(std::floor(room)));
  if (half < min_half_window) return CornerRejection::at_border;
  const auto moved_to = refine_once(grey, guess.pixel_px, half);
  if (!moved_to) return CornerRejection::moved_too_far;
  const Eigen::Vector2d moved_px = *moved_to - guess.pixel_px;
  if (moved_px.norm() > always_within_px &&
      (guess.px_per_m.inverse() * moved_px).norm() > guess.reach_m) {
    return CornerRejection::moved_too_far;
  }
  guess.pixel_px = *moved_to;
  guess.half_window_px = half;
  return std::nullopt;
}

/// Distance of a corner from the position predicted by its nearest neighbours, relative to the
/// tolerance; 0 if they do not predict one.
double relative_deviation(const std::vector<CornerGuess>& corners,
                          const std::vector<Eigen::Vector3d>& target_m,
                          std::size_t index) {
  const Eigen::Vector2d own = target_m[corners[index].id].head<2>();
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i != index) near.emplace_back((target_m[corners[i].id].head<2>() - own).norm(), i);
  }
  const std::size_t count = std::min(neighbours, near.size());
  if (count < min_neighbours) return 0;
  std::partial_sort(near.begin(), near.begin() + static_cast<long>(count), near.end());
  std::vector<Eigen::Vector2d> from, to;
  for (std::size_t k = 0; k < count; ++k) {
    from.push_back(target_m[corners[near[k].second].id].head<2>());
    to.push_back(corners[near[k].second].pixel_px);
  }
  const auto H = fit_homography(from, to);
  if (!H) return 0;
  // Distortion bends the neighbourhood: allow for the neighbours' own deviation.
  double squares = 0, apart = 0;
  for (std::size_t k = 0; k < count; ++k) {
    squares += (map_point(*H, from[k]) - to[k]).squaredNorm();
    apart += (to[k] - corners[index].pixel_px).norm() / static_cast<double>(count);
  }
  const double deviation = std::sqrt(squares / static_cast<double>(count));
  const double tolerable = std::max({0.8, 0.01 * apart, 6 * deviation});
  return (map_point(*H, own) - corners[index].pixel_px).norm() / tolerable;
}

/// Removes corners without a crossing of squares, if the board has crossings at its corners.
void drop_covered_corners(const cv::Mat& grey,
                          CornerKind kind,
                          std::vector<CornerGuess>& corners,
                          std::vector<RejectedCorner>& refused) {
  std::vector<CornerGuess> crossings;
  std::vector<RejectedCorner> others;
  for (const CornerGuess& corner : corners) {
    if (is_crossing(grey, corner.pixel_px, corner.half_window_px)) {
      crossings.push_back(corner);
    } else {
      others.push_back({corner.id, CornerRejection::not_crossing});
    }
  }
  constexpr double most = 0.6;
  if (kind == CornerKind::as_most && crossings.size() < most * corners.size()) return;
  corners = std::move(crossings);
  refused.insert(refused.end(), others.begin(), others.end());
}

/// Removes the most deviating corner until none deviates.
void drop_deviating_corners(std::vector<CornerGuess>& corners,
                            const std::vector<Eigen::Vector3d>& target_m,
                            std::vector<RejectedCorner>& refused) {
  while (true) {
    double most = 1;
    std::size_t worst = corners.size();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const double relative = relative_deviation(corners, target_m, i);
      if (relative > most) {
        most = relative;
        worst = i;
      }
    }
    if (worst == corners.size()) return;
    refused.push_back({corners[worst].id, CornerRejection::off_neighbours});
    corners.erase(corners.begin() + static_cast<long>(worst));
  }
}

}  // namespace

void refine_corners(const cv::Mat& grey,
                    std::vector<CornerGuess> guesses,
                    const std::vector<Eigen::Vector3d>& target_m,
                    CornerKind kind,
                    BoardDetection& result) {
  std::sort(guesses.begin(), guesses.end(),
            [](const CornerGuess& a, const CornerGuess& b) { return a.id < b.id; });
  std::vector<CornerGuess> refined;
  for (CornerGuess& guess : guesses) {
    if (const auto refusal = refine(grey, guess)) {
      result.rejected_corners.push_back({guess.id, *refusal});
    } else {
      refined.push_back(guess);
    }
  }
  drop_covered_corners(grey, kind, refined, result.rejected_corners);
  drop_deviating_corners(refined, target_m, result.rejected_corners);
  for (const CornerGuess& corner : refined) {
    result.ids.push_back(corner.id);
    result.corners_px.push_back(corner.pixel_px);
  }
}

}  // namespace vernier::internal
