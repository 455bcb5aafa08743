// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/evaluation/corner_repeatability.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "stereo/canny_edges.h"
#include "stereo/corners/corner_match.h"
#include "stereo/evaluation/edge_error.h"
#include "stereo/matcher.h"
#include "stereo/matcher_evaluation.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo::internal {
namespace {

constexpr double displaced_px = 12;

/// Looks up the truth at corners as if they were edge points.
std::vector<TruthAtEdge> truth_at_corners(const std::vector<Eigen::Vector2d>& corners_px,
                                          const StereoTruth& truth) {
  std::vector<EdgePoint> points;
  for (const Eigen::Vector2d& corner : corners_px) {
    EdgePoint point;
    point.x = static_cast<int>(std::lround(corner.x()));
    point.y = static_cast<int>(std::lround(corner.y()));
    point.pixel_px = corner.cast<float>();
    point.row_x_px = static_cast<float>(corner.x());
    points.push_back(point);
  }
  return truth_at(truth, points);
}

double error_of(const Eigen::Vector2d& left, const Eigen::Vector2d& right, const TruthAtEdge& at) {
  EdgeDisparity found;
  found.disparity_px = static_cast<float>(left.x() - right.x());
  return std::hypot(error_px(found, at, DiscontinuityRule::either), right.y() - left.y());
}

class RightCorners {
 public:
  RightCorners(std::vector<Eigen::Vector2d> corners_px, double within_px)
      : corners_(std::move(corners_px)), within_(within_px) {
    std::sort(corners_.begin(), corners_.end(), [](const auto& a, const auto& b) {
      return a.y() < b.y() || (a.y() == b.y() && a.x() < b.x());
    });
  }

  bool has(const Eigen::Vector2d& left, const TruthAtEdge& at) const {
    const auto begin = std::lower_bound(corners_.begin(), corners_.end(), left.y() - within_,
                                        [](const auto& c, double y) { return c.y() < y; });
    for (auto c = begin; c != corners_.end() && c->y() <= left.y() + within_; ++c) {
      if (error_of(left, *c, at) <= within_) return true;
    }
    return false;
  }

 private:
  std::vector<Eigen::Vector2d> corners_;
  double within_;
};

}  // namespace

std::vector<CornerRepeatability> corner_repeatabilities(
    const std::vector<Eigen::Vector2d>& left_px,
    const std::vector<Eigen::Vector2d>& right_px,
    const StereoTruth& truth,
    const CornerRepeatOptions& options) {
  const std::vector<TruthAtEdge> at = truth_at_corners(left_px, truth);
  const RightCorners right(right_px, options.within_px);
  std::vector<CornerRepeatability> repeats;
  for (std::size_t i = 0; i < left_px.size(); ++i) {
    if (!at[i].known || at[i].occluded) continue;
    const double x = left_px[i].x() - at[i].disparity_px;
    if (x < options.border_px || x > truth.disparity.width_px - 1 - options.border_px) continue;
    CornerRepeatability repeat{left_px[i], right.has(left_px[i], at[i]), 0};
    for (const int dx : {-1, 0, 1}) {
      for (const int dy : {-1, 0, 1}) {
        if (dx == 0 && dy == 0) continue;
        const Eigen::Vector2d moved = left_px[i] + displaced_px * Eigen::Vector2d(dx, dy);
        repeat.chance += right.has(moved, at[i]) ? 1.0 / 8 : 0;
      }
    }
    repeats.push_back(repeat);
  }
  return repeats;
}

std::vector<CornerError> corner_errors(const std::vector<CornerMatch>& matches,
                                       const StereoTruth& truth) {
  std::vector<Eigen::Vector2d> left_px;
  left_px.reserve(matches.size());
  for (const CornerMatch& match : matches) left_px.push_back(match.left_px);
  const std::vector<TruthAtEdge> at = truth_at_corners(left_px, truth);
  std::vector<CornerError> errors;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!at[i].known) continue;
    errors.push_back({left_px[i], error_of(left_px[i], matches[i].right_px, at[i])});
  }
  return errors;
}

}  // namespace vernier::stereo::internal
