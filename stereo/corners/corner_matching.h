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

/// An image and its corners.
struct CornerImage {
  cv::Mat grey;      ///< as CV_32F
  double noise = 0;  ///< grey values
  std::vector<ImageCorner> corners;
};

/// Measures the noise and finds the corners of an 8-bit image.
CornerImage corner_image(const cv::Mat& grey, const HarrisOptions& options);

/// Corners matched from left to right, in the order of the left ones:
///
///  1. candidates: right corners within the gate of the left one's band
///  (stereo/corners/epipolar_band.h);
///  2. the one whose patch correlates best (ZNCC), if by at least `min_score`, if by
///     `min_margin` more than the second best, and if it has no better left one itself;
///  3. least squares matching about both (stereo/image/patch_alignment.h) has to settle within
///     `max_shift_px` of the corner and correlate by `min_aligned_score`; its place is the
///     match's right pixel;
///  4. of the `neighbours` nearest matches at least `support` have nearly the same displacement: it
///     differs by a pixel or by `support_slope` of their distance. Where fewer matches than
///     `neighbours` are left this is not asked.
///
/// `candidates`, where given, is set to their number. Throws Error where options make no sense.
std::vector<CornerMatch> match_corners(const CornerImage& left,
                                       const CornerImage& right,
                                       const EpipolarBand& band,
                                       const CornerMatchingOptions& options = {},
                                       long* candidates = nullptr);

}  // namespace vernier::stereo::internal
