// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace vernier::stereo::internal {

/// A corner seen in both images.
struct CornerMatch {
  int left = 0, right = 0;   ///< indices of the corners
  Eigen::Vector2d left_px;   ///< the left corner
  Eigen::Vector2d right_px;  ///< where the right image shows the same, by least squares matching
  /// Standard deviation of each of the four coordinates, were they equal and independent, that
  /// gives the error across the epipolar curve: σ² = nᵀ C n / 2 + floor², C the registration's
  /// covariance
  double sigma_px = 0;
  double score = 0;  ///< ZNCC of the aligned patches
};

/// How corners are matched (match_corners).
struct CornerMatchingOptions {
  double gate_probability = 0.997;  ///< that the true right corner is a candidate
  int patch_half_px = 6;            ///< correlated patches are 2 half + 1 pixels wide
  double min_score = 0.8;           ///< ZNCC of the best candidate
  double min_margin = 0.05;         ///< and how much less the second best has
  int aligned_half_px = 7;          ///< of the patches that are aligned
  double min_aligned_score = 0.9;   ///< ZNCC of the aligned patches
  double max_shift_px = 1;          ///< from the right corner to the aligned place
  int neighbours = 10;              ///< matches about a match that are asked …
  int support = 3;                  ///< … and how many have to agree
  double support_slope = 0.2;       ///< disagreement allowed, pixels a pixel of distance
  double sigma_floor_px = 0.05;     ///< of sigma_px
};

}  // namespace vernier::stereo::internal
