// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/corners/corner_image.h"
#include "stereo/corners/corner_match.h"
#include "stereo/corners/epipolar_band.h"

namespace vernier::stereo::internal {

/// Corners matched from left to right, in the order of the left corners:
///
///  1. candidates: right corners within the gate of the left corner's epipolar band
///     (stereo/corners/epipolar_band.h);
///  2. the candidate with the best patch correlation (ZNCC), the right patch sampled through the
///     prior's derivative ∂ right / ∂ left at the candidate's depth, if it reaches `min_score`,
///     leads the second best by `min_margin`, and has no better left corner itself;
///  3. least squares matching around both (stereo/image/patch_alignment.h) must converge within
///     `max_shift_px` of the corner with a ZNCC of at least `min_aligned_score`; the result is the
///     right pixel of the match;
///  4. at least `support` of the `neighbours` nearest matches must nearly agree with
///     that derivative: their offset differs by at most a pixel or `support_slope` times itself.
///     Skipped if fewer matches than `neighbours` are left.
///
/// Patches are those of the reduced images; pixels and standard deviations are in the images as
/// taken. Sets `candidates`, if given, to the number of candidates. Throws Error for options out of
/// range.
std::vector<CornerMatch> match_corners(const CornerImage& left,
                                       const CornerImage& right,
                                       const EpipolarBand& band,
                                       const CornerMatchingOptions& options = {},
                                       long* candidates = nullptr);

}  // namespace vernier::stereo::internal
