// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace vernier::stereo::internal {

/// A corner matched in both images.
struct CornerMatch {
  int left = 0, right = 0;   ///< indices into the lists of corners
  Eigen::Vector2d left_px;   ///< position of the left corner
  Eigen::Vector2d right_px;  ///< matching position in the right image, by least squares matching
  /// Standard deviation of each of the four coordinates, taken as equal and independent, that
  /// reproduces the error across the epipolar curve: σ² = nᵀ C n / 2 + floor², C the covariance of
  /// the alignment. With images reduced by r_l and r_r, 2 nᵀ (C / 2 + floor² 1) n / (r_l⁻² +
  /// r_r⁻²).
  double sigma_px = 0;
  double score = 0;  ///< ZNCC of the aligned patches
  /// ∂ right / ∂ left for a surface at constant depth, by the prior.
  Eigen::Matrix2d right_by_left = Eigen::Matrix2d::Identity();
};

/// Options of match_corners.
struct CornerMatchingOptions {
  double gate_probability = 0.997;  ///< probability that the true right corner is a candidate
  int patch_half_px = 6;            ///< correlation patches are 2 half + 1 pixels wide
  double min_score = 0.8;           ///< minimum ZNCC of the best candidate
  double min_margin = 0.05;         ///< minimum lead in ZNCC over the second best candidate
  int aligned_half_px = 7;          ///< half-size of the patches for least squares matching
  double min_aligned_score = 0.9;   ///< minimum ZNCC of the aligned patches
  double max_shift_px = 1;       ///< maximum distance of the aligned position from the right corner
  int neighbours = 10;           ///< number of nearest matches checked for consistency …
  int support = 3;               ///< … and how many of them must agree
  double support_slope = 0.2;    ///< allowed disagreement, pixels per pixel of distance
  double sigma_floor_px = 0.05;  ///< minimum of sigma_px, added in quadrature
};

}  // namespace vernier::stereo::internal
