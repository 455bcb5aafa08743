// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "stereo/canny_edges.h"

namespace vernier::stereo::internal {

/// Running sums for orthogonal line regression.
class LineRegression {
 public:
  void add(const Eigen::Vector2d& p);
  /// The regression without the points already in an earlier state.
  LineRegression since(const LineRegression& earlier) const;

  int count() const { return count_; }
  Eigen::Vector2d centroid() const { return sum_ / count_; }
  Eigen::Vector2d direction() const;  ///< along the line, of either sign
  double squares() const;             ///< sum of squared distances from the line
  /// RMS distance, with n − 2 degrees of freedom.
  double rms() const;

 private:
  Eigen::Matrix2d scatter() const;

  Eigen::Vector2d sum_{0, 0};
  Eigen::Matrix2d products_ = Eigen::Matrix2d::Zero();
  int count_ = 0;
};

/// A line fitted to edge points, with its covariance (edge_segments.h).
struct EdgeLine {
  /// Fits the points with these indices; `scale_px` is the scale of the gradient.
  EdgeLine(const std::vector<EdgePoint>& points, std::span<const int> places, double scale_px);

  double along(const Eigen::Vector2d& p) const { return direction.dot(p - centroid); }
  double across(const Eigen::Vector2d& p) const { return normal.dot(p - centroid); }
  Eigen::Vector2d at(double along_px) const { return centroid + along_px * direction; }
  /// Variance of the line's position across it, at a position along it.
  double across_variance(double along_px) const;

  Eigen::Vector2d centroid, direction, normal;  ///< the normal points towards the brighter side
  double rms_px = 0;
  double spacing_px = 0;             ///< mean distance of consecutive points
  Eigen::Matrix2d covariance;        ///< of the offset across at the centroid, and of the slope
  Eigen::Matrix2d noise_covariance;  ///< the same without the factor for too large residuals

 private:
  void propagate(const std::vector<EdgePoint>& points,
                 std::span<const int> places,
                 double scale_px);
};

}  // namespace vernier::stereo::internal
