// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vernier::stereo::internal {

/// A matched point of a straight edge.
struct DisparitySample {
  double along_px = 0;  ///< position along the edge
  double disparity_px = 0;
  double sigma_px = 0;   ///< of the disparity
  double shared_px = 0;  ///< part of it that is common to the edge's points
  int point = 0;
};

struct DisparityLineOptions {
  int min_points = 6;
  double max_off_sigma = 3;
  /// Correlation length of the noise; the correlation falls to 0 linearly.
  double noise_length_px = 8;
  double floor_length_px = 30;  ///< correlation length of the common part
};

/// A disparity d(s) = d_0 + d_1 (s − s_0) along an edge
/// (stereo/reconstruction/segment_disparity.h).
struct DisparityLine {
  double along_px = 0;  ///< s_0
  Eigen::Vector2d coefficients{0, 0};
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  /// The part of it from noise, new in every image of the same scene: without what points share,
  /// and without the factor for residuals that are larger than expected.
  Eigen::Matrix2d noise_covariance = Eigen::Matrix2d::Zero();
  double rms_px = 0;
  std::vector<DisparitySample> samples;  ///< samples on the line

  double at(double s) const { return row(s).dot(coefficients); }
  double slope() const { return coefficients[1]; }
  double noise_variance(double s) const { return row(s).dot(noise_covariance * row(s)); }
  /// Covariance of d at two positions.
  double covariance_of(double s, double t) const { return row(s).dot(covariance * row(t)); }

 private:
  Eigen::Vector2d row(double s) const { return {1, s - along_px}; }
};

/// Fits lines to the samples of one edge, given in order along it: each line has at least
/// `min_points` samples, with few others in between.
std::vector<DisparityLine> disparity_lines(const std::vector<DisparitySample>& samples,
                                           const DisparityLineOptions& options);

}  // namespace vernier::stereo::internal
