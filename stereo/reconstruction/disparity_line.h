// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::stereo::internal {

/// A matched point of a straight edge.
struct DisparitySample {
  double along_px = 0;  ///< its place on the edge
  double disparity_px = 0;
  double sigma_px = 0;   ///< of the disparity
  double shared_px = 0;  ///< part of it that the edge's points have in common
  int point = 0;
};

struct DisparityLineOptions {
  int min_points = 6;
  double max_off_sigma = 3;
  double noise_length_px = 8;   ///< over which noise is shared: falls to 0 linearly
  double floor_length_px = 30;  ///< over which the shared part is
};

/// A disparity d(s) = d_0 + d_1 (s − s_0) along an edge
/// (stereo/reconstruction/segment_disparity.h).
struct DisparityLine {
  double along_px = 0;  ///< s_0
  Eigen::Vector2d coefficients{0, 0};
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double rms_px = 0;
  std::vector<DisparitySample> samples;  ///< those on it

  double at(double s) const { return row(s).dot(coefficients); }
  double slope() const { return coefficients[1]; }
  /// Of d at two places.
  double covariance_of(double s, double t) const { return row(s).dot(covariance * row(t)); }

 private:
  Eigen::Vector2d row(double s) const { return {1, s - along_px}; }
};

/// The lines that the samples of one edge, in their order along it, are on: each of at least
/// `min_points` of them with hardly any other between.
std::vector<DisparityLine> disparity_lines(const std::vector<DisparitySample>& samples,
                                           const DisparityLineOptions& options);

}  // namespace vernier::stereo::internal
