// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/matcher.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo {

/// What counts as right within a pixel of a step of the truth.
enum class DiscontinuityRule {
  either,  ///< any disparity of the 3 x 3 pixels: which surface an edge is of is not known better
  foreground,  ///< the largest of them
};

struct EvaluationOptions {
  double min_angle_rad = 0.0873;  ///< edges nearer to the row (5°) are not asked
  int border_px = 3;              ///< nor those nearer to the left and right border
  DiscontinuityRule outline = DiscontinuityRule::either;
};

/// Figures over some of the edges. Shares are 0 where there is nothing to share.
struct EdgeMetrics {
  int edges = 0;       ///< with a known truth that the right image shows
  int matched = 0;     ///< of them
  double density = 0;  ///< matched over edges
  double bad_0_5 = 0, bad_1 = 0, bad_2 = 0, bad_3 = 0;  ///< of the matched, |error| above, px
  double rms_inlier_px = 0;                             ///< of errors up to 1 px
  double bias_inlier_px = 0;                            ///< their mean
};

/// How a matcher did at the left edges of a pair.
struct MatcherScore {
  EdgeMetrics all, smooth, discontinuity;  ///< … away from steps of the truth, and at them
  std::vector<EdgeMetrics> by_angle;       ///< nine bins of 10° from the row to upright
  int occluded = 0;                        ///< edges that the right image does not show …
  int occluded_matched = 0;                ///< … and that were matched all the same
  double mismatch = 0;  ///< |error| > 3 px among all matched, occluded ones included
  /// Of smooth matched edges with a standard deviation: how many errors are within 1.96 of it, and
  /// the root mean square of error over it, without those above 1 px.
  int stated = 0;
  double coverage_95 = 0, z_rms = 0;
};

MatcherScore evaluate(const std::vector<EdgePoint>& edges,
                      const std::vector<EdgeDisparity>& found,
                      const std::vector<TruthAtEdge>& truth,
                      int width_px,
                      const EvaluationOptions& options = {});

/// A point of the curve of error against density.
struct CurvePoint {
  double min_confidence = -std::numeric_limits<double>::infinity();
  double density = 0, bad_1 = 0, mismatch = 0;
};

struct DensityCurveOptions {
  int points = 20;
  EvaluationOptions scored;  ///< which edges count, and what is right
};

/// The curve as the least confident matches are left out one by one, at so many densities evenly
/// from all to none, the densest first. Of equal confidences all or none are left out.
std::vector<CurvePoint> density_curve(const std::vector<EdgePoint>& edges,
                                      const std::vector<EdgeDisparity>& found,
                                      const std::vector<TruthAtEdge>& truth,
                                      int width_px,
                                      const DensityCurveOptions& options = {});

/// bad_1 of a curve at a density, linearly between its points; that of the nearer end beyond them.
double bad_1_at(const std::vector<CurvePoint>& curve, double density);

}  // namespace vernier::stereo
