// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/matcher.h"
#include "stereo/stereo_truth.h"

namespace vernier::stereo {

/// Which disparity counts as correct within a pixel of a truth discontinuity.
enum class DiscontinuityRule {
  either,      ///< any disparity of the 3 x 3 pixels: the edge may belong to either surface
  foreground,  ///< the largest of them
};

struct EvaluationOptions {
  double min_angle_rad = 0.0873;  ///< edges closer to horizontal (5°) are not scored
  int border_px = 3;              ///< edges closer to the left or right border are not scored
  DiscontinuityRule outline = DiscontinuityRule::either;
};

/// Statistics over a subset of the edges. Fractions of an empty set are 0.
struct EdgeMetrics {
  int edges = 0;       ///< with known truth and visible in the right image
  int matched = 0;     ///< number of them that are matched
  double density = 0;  ///< matched / edges
  /// Fractions of the matched edges with |error| above 0.5, 1, 2 and 3 px.
  double bad_0_5 = 0, bad_1 = 0, bad_2 = 0, bad_3 = 0;
  int inliers = 0;            ///< errors up to 1 px …
  double rms_inlier_px = 0;   ///< … their RMS
  double bias_inlier_px = 0;  ///< their mean
};

/// Score of a matcher at the left edges of a pair.
struct MatcherScore {
  EdgeMetrics all, smooth, discontinuity;  ///< smooth: away from truth discontinuities
  std::vector<EdgeMetrics> by_angle;       ///< nine bins of 10°, from horizontal to vertical
  int occluded = 0;                        ///< edges not visible in the right image …
  int occluded_matched = 0;                ///< … of which matched nevertheless
  /// Fraction of all matched edges, occluded ones included, with |error| > 3 px.
  double mismatch = 0;
  /// For smooth matched edges with a standard deviation: fraction of errors within 1.96 of it, and
  /// RMS of error over standard deviation, excluding errors above 1 px.
  int stated = 0;
  double coverage_95 = 0, z_rms = 0;
};

MatcherScore evaluate(const std::vector<EdgePoint>& edges,
                      const std::vector<EdgeDisparity>& found,
                      const std::vector<TruthAtEdge>& truth,
                      int width_px,
                      const EvaluationOptions& options = {});

/// A point of an error–density curve.
struct CurvePoint {
  double min_confidence = -std::numeric_limits<double>::infinity();
  double density = 0, bad_1 = 0, mismatch = 0;
};

struct DensityCurveOptions {
  int points = 20;
  EvaluationOptions scored;  ///< which edges count, and what is right
};

/// Curve obtained by dropping the least confident matches, at so many densities spaced evenly from
/// all to none, densest first. Matches of equal confidence are dropped together.
std::vector<CurvePoint> density_curve(const std::vector<EdgePoint>& edges,
                                      const std::vector<EdgeDisparity>& found,
                                      const std::vector<TruthAtEdge>& truth,
                                      int width_px,
                                      const DensityCurveOptions& options = {});

/// bad_1 of a curve at a density, interpolated linearly; clamped beyond its ends.
double bad_1_at(const std::vector<CurvePoint>& curve, double density);

}  // namespace vernier::stereo
