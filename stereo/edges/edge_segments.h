// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/segment.h"

namespace vernier::stereo::internal {

struct EdgeSegmentOptions {
  double max_rms_px = 0.15;  ///< maximum RMS distance of a segment's points from its line
  int min_points = 8;        ///< shorter segments are dropped
  /// Scale of canny_edges, which sets the correlation length of the point noise.
  double scale_px = 1;
};

/// A straight piece of an edge. Seen from a to b, the brighter side is on the right.
struct EdgeSegment {
  ImageSegment segment;
  Eigen::Matrix2d a_covariance_px2, b_covariance_px2;
  /// Ends at the corner with the adjacent segment of its chain.
  bool a_is_corner = false, b_is_corner = false;
  double rms_px = 0;        ///< RMS distance of the points from the line
  std::vector<int> points;  ///< its points from a to b, as indices into the list of points
};

/// Polygonal segments of edge points (of canny_edges, sorted by (y, x)). A segment grows along its
/// chain while the RMS distance of its points from their orthogonal regression line is below
/// `max_rms_px`; then the next one begins. Points at its ends that lie off the line of the others
/// (rounded corners) are removed.
///
/// The line's offset across at s along it, e(s) = e_0 + e_1 s, has the covariance
///
///     H C Hᵀ max(1, Σ r² / tr((I − P) C)),   C_ij = σ_i σ_j exp(−(s_i − s_j)² / (4 (σ² + 2/3)))
///
/// with H the regression, P its projection, and C the noise of points with standard deviation σ_i,
/// correlated along the edge by the gradient filter of scale σ and the 3 x 3 pixels of their fit.
/// Residuals r larger than expected indicate an edge that is not straight or less accurate than
/// computed. Two segments of a chain that meet at a corner both end at the intersection of their
/// lines, with propagated covariance. Elsewhere a segment ends at its last point. Canny chains stop
/// short of junctions, so the physical edge continues a little: such an end has a standard
/// deviation of 3 px along the line, the RMS distance measured to T-junctions of 60° to 90°
/// (docs/edges.md). Sorted by the first point. Throws Error for unsorted points and for options out
/// of range.
std::vector<EdgeSegment> edge_segments(const std::vector<EdgePoint>& points,
                                       const EdgeSegmentOptions& options = {});

}  // namespace vernier::stereo::internal
