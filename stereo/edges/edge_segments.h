// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/segment.h"

namespace vernier::stereo::internal {

struct EdgeSegmentOptions {
  double max_rms_px = 0.15;  ///< of a segment's points from its line
  int min_points = 8;        ///< shorter segments are dropped
  double scale_px = 1;       ///< of canny_edges: how far the noise of points is correlated
};

/// A straight piece of an edge. From a to b the brighter side is on the right.
struct EdgeSegment {
  ImageSegment segment;
  Eigen::Matrix2d a_covariance_px2, b_covariance_px2;
  bool a_is_corner = false, b_is_corner = false;  ///< where it meets the next one of its string
  double rms_px = 0;                              ///< of the points from the line
  std::vector<int> points;  ///< on it, from a to b, by their places in the list of points
};

/// Polygonal segments of edge points (of canny_edges, sorted by (y, x)). A segment grows along its
/// string as long as the orthogonal regression to its points has a root mean square below
/// `max_rms_px`, then the next begins; points at its ends that lie off the line of the others (the
/// rounding of a corner) are given back.
///
/// The line across at s along it, e(s) = e_0 + e_1 s, has the covariance
///
///     H C Hᵀ max(1, Σ r² / tr((I − P) C)),   C_ij = σ_i σ_j exp(−(s_i − s_j)² / (4 (σ² + 2/3)))
///
/// with H the regression, P its projection, and C the noise of points of standard deviation σ_i,
/// correlated along the edge by the gradient's filter of scale σ and the 3 x 3 pixels of their fit;
/// residuals r that are larger than that say that the edge is not straight or not so well known.
/// Where two segments of a string meet at a corner both end at the intersection of their lines,
/// with its covariance by propagation. Elsewhere a segment ends at its last point. Canny's strings
/// break off before a junction, so what ends there goes on a little: along the line such an end has
/// a standard deviation of 3 px, the root mean square distance measured to T-junctions of 60° to
/// 90° (docs/edges.md). Sorted by the first point. Throws Error on points that are not sorted and
/// on options out of range.
std::vector<EdgeSegment> edge_segments(const std::vector<EdgePoint>& points,
                                       const EdgeSegmentOptions& options = {});

}  // namespace vernier::stereo::internal
