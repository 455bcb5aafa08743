// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

namespace vernier::stereo {

struct EdgeMatcherOptions {
  double min_angle_rad = 0.0873;  ///< edges nearer to the row (5°) are left out
  double min_margin = 0;          ///< of the best disparity over the next other one, relative
  int min_points = 6;             ///< fewer points that agree with each other are dropped …
  int agreement_reach_px = 5;     ///< … where agreeing ones are within so many pixels
  /// Share of unmatched points, or of refined ones whose disparity changes by more than 0.2 px a
  /// pixel, from which slanted surfaces are tried.
  double slanted_above = 0.3;
  bool refine = true;      ///< least squares, with a standard deviation for each point
  double min_score = 0.9;  ///< ZNCC of the refined patches; else the support's parabola stands …
  double min_slanted_score = 0.7;   ///< the same where surfaces slant
  double unrefined_sigma_px = 0.5;  ///< … with this standard deviation
  double sigma_floor_px =
      0.2;  ///< of refined points, added in squares: what real images have beyond noise
};

/// What `edge` knows of a left edge point.
struct EdgeMatch {
  EdgeDisparity at;
  float stretch = 1;     ///< du_right / du_left over the patch
  float shear = 0;       ///< du_right / dv there
  bool refined = false;  ///< else the disparity is the support's parabola
};

/// Vernier's own matcher, sparse from the start:
///
///  1. costs of every left edge point at every disparity: census words (stereo/matching/census.h),
///  3 x 3 of
///     them;
///  2. semi-global support between edge points (stereo/matching/edge_support.h);
///  3. the same from the places found in the right image; a point is kept where both find the same
///     disparity but for one, its best is `min_margin` better than any other, and at least
///     `min_points` neighbours in a chain agree with it;
///  4. least squares of gain, offset, shift, stretch and shear
///  (stereo/matching/disparity_refinement.h),
///     then once more from the surfaces of neighbours at points where nothing was found.
///
/// One for each of `left_edges`, which are in the order of canny_edges. Throws Error on images of
/// unequal size and on an empty or too wide range.
std::vector<EdgeMatch> match_edges(const RectifiedPair& pair,
                                   const std::vector<EdgePoint>& left_edges,
                                   const DisparityRange& range,
                                   const EdgeMatcherOptions& options = {});

/// The same as a plug-in of the name `edge`.
Matcher edge_matcher(const EdgeMatcherOptions& options = {});

}  // namespace vernier::stereo
