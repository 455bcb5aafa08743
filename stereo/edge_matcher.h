// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/grey_levels.h"
#include "stereo/matcher.h"

namespace vernier::stereo {

struct EdgeMatcherOptions {
  double min_angle_rad = 0.0873;  ///< edges closer to horizontal (5°) are excluded
  double min_margin = 0;  ///< relative margin of the best disparity over the best one elsewhere
  int min_points = 6;     ///< smaller groups of consistent points are dropped …
  int agreement_reach_px = 5;  ///< … grouping points within this distance, in pixels
  /// Fraction of unmatched points, or of refined points with a disparity gradient above 0.2 px per
  /// pixel, above which slanted surfaces are searched as well.
  double slanted_above = 0.3;
  /// Compare grey levels beside edges too, which tells the outlines of plain frames and bars from
  /// one another.
  bool compare_levels = true;
  bool refine = true;      ///< least squares refinement, with a standard deviation for each point
  double min_score = 0.9;  ///< minimum refined ZNCC; else the support parabola is kept …
  double min_slanted_score = 0.7;   ///< minimum ZNCC for slanted surfaces
  double unrefined_sigma_px = 0.5;  ///< … with this standard deviation
  double sigma_floor_px = 0.2;      ///< added in quadrature to that of refined points
};

/// Result of the `edge` matcher at a left edge point.
struct EdgeMatch {
  EdgeDisparity at;
  float stretch = 1;     ///< du_right / du_left over the patch
  float shear = 0;       ///< du_right / dv over the patch
  bool refined = false;  ///< false: the disparity is that of the support parabola
};

/// Vernier's own sparse matcher:
///
///  1. costs of every left edge point at every disparity: 3 x 3 census words
///     (stereo/matching/census.h) and, with `compare_levels`, the grey levels on both sides of the
///     edge, the right image's by a tone curve that is found from the pair
///     (stereo/matching/tone_curve.h);
///  2. semi-global support between edge points (stereo/matching/edge_support.h);
///  3. the same from the matched positions in the right image; a point is kept if both directions
///     agree within one disparity, its best disparity leads any other by `min_margin`, and at least
///     `min_points` connected neighbours agree with it;
///  4. least squares for gain, offset, shift, stretch and shear
///     (stereo/matching/disparity_refinement.h), then again at unmatched points, starting from the
///     surfaces of their neighbours.
///
/// Returns one result per point of `left_edges`, which must be in the order of canny_edges. Throws
/// Error for images of different sizes and for an empty or too wide range.
std::vector<EdgeMatch> match_edges(const RectifiedPair& pair,
                                   const std::vector<EdgePoint>& left_edges,
                                   const DisparityRange& range,
                                   const EdgeMatcherOptions& options = {});

/// The same as a plug-in named `edge`.
Matcher edge_matcher(const EdgeMatcherOptions& options = {});

}  // namespace vernier::stereo
