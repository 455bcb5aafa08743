// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {

/// Sums for the orthogonal regression of a line to points.
class LineRegression {
 public:
  void add(const Eigen::Vector2d& p);
  /// Without the points that were in it at an earlier time.
  LineRegression since(const LineRegression& earlier) const;

  int count() const { return count_; }
  Eigen::Vector2d centroid() const { return sum_ / count_; }
  Eigen::Vector2d direction() const;  ///< along the line, either way
  double squares() const;             ///< sum of the squared distances from the line
  /// Of the distances, for n − 2 degrees of freedom.
  double rms() const;

 private:
  Eigen::Matrix2d scatter() const;

  Eigen::Vector2d sum_{0, 0};
  Eigen::Matrix2d products_ = Eigen::Matrix2d::Zero();
  int count_ = 0;
};

/// A line through edge points, and how well it is known (edge_segments.h).
struct EdgeLine {
  /// Through the points of these places; `scale_px` is the gradient's.
  EdgeLine(const std::vector<EdgePoint>& points, std::span<const int> places, double scale_px);

  double along(const Eigen::Vector2d& p) const { return direction.dot(p - centroid); }
  double across(const Eigen::Vector2d& p) const { return normal.dot(p - centroid); }
  Eigen::Vector2d at(double along_px) const { return centroid + along_px * direction; }
  /// Of the line itself, across it, at a place along it.
  double across_variance(double along_px) const;

  Eigen::Vector2d centroid, direction, normal;  ///< the normal is towards the brighter side
  double rms_px = 0;
  double spacing_px = 0;       ///< mean distance of consecutive points
  Eigen::Matrix2d covariance;  ///< of the offset across at the centroid, and of the slope

 private:
  void propagate(const std::vector<EdgePoint>& points,
                 std::span<const int> places,
                 double scale_px);
};

}  // namespace vernier::stereo::internal
