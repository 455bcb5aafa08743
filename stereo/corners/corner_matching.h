// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "stereo/corners/corner_match.h"
#include "stereo/corners/epipolar_band.h"
#include "stereo/corners/harris_corners.h"

namespace vernier::stereo::internal {

/// A grey image with its corners.
struct CornerImage {
  cv::Mat grey;      ///< as CV_32F
  double noise = 0;  ///< standard deviation, grey levels
  std::vector<ImageCorner> corners;
};

/// Measures the noise of an 8-bit image and detects its corners.
CornerImage corner_image(const cv::Mat& grey, const HarrisOptions& options);

/// Corners matched from left to right, in the order of the left corners:
///
///  1. candidates: right corners within the gate of the left corner's epipolar band
///     (stereo/corners/epipolar_band.h);
///  2. the candidate with the best patch correlation (ZNCC), if it reaches `min_score`, leads the
///     second best by `min_margin`, and has no better left corner itself;
///  3. least squares matching around both (stereo/image/patch_alignment.h) must converge within
///     `max_shift_px` of the corner with a ZNCC of at least `min_aligned_score`; the result is the
///     right pixel of the match;
///  4. at least `support` of the `neighbours` nearest matches must have nearly the same
///     displacement: the difference is at most a pixel or `support_slope` times their distance.
///     Skipped if fewer matches than `neighbours` are left.
///
/// Sets `candidates`, if given, to the number of candidates. Throws Error for options out of range.
std::vector<CornerMatch> match_corners(const CornerImage& left,
                                       const CornerImage& right,
                                       const EpipolarBand& band,
                                       const CornerMatchingOptions& options = {},
                                       long* candidates = nullptr);

}  // namespace vernier::stereo::internal
