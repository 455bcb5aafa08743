// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "stereo/canny_edges.h"
#include "stereo/edges/edge_segments.h"
#include "stereo/matcher.h"
#include "stereo/segment.h"

namespace vernier::stereo::internal {

struct SegmentDisparityOptions {
  double min_angle_rad = 0.0873;  ///< segments closer to horizontal (5°) are rejected
  int min_points = 6;             ///< minimum number of matched points on one line
  double min_share = 0.5;         ///< minimum fraction of them among a part's edge points
  double max_off_sigma = 3;       ///< points farther from the line are outliers
  double reach_px = 8;            ///< maximum extension of a part beyond its inliers …
  double end_sigma_px = 3;  ///< … and the standard deviation along the line of an end placed there
  double unstated_sigma_px = 0.5;  ///< used if the matcher gives no standard deviation
  double floor_px = 0.2;           ///< scene-dependent part of the matcher's σ …
  double floor_length_px = 30;     ///< … correlated along an edge as exp(−distance / this)
  double scale_px = 1;             ///< scale of canny_edges
  /// Covariance of a disparity with its edge's position along the row, relative to the variance of
  /// that position: 0.85 ± 0.07 measured on rendered edges; 1 for an optimal edge detector, 0 for
  /// disparities that do not come from the image.
  double moved_alike = 0.85;
};

/// Why a segment has a disparity or not.
enum class SegmentStatus {
  placed,
  along_row,  ///< too close to horizontal: its disparity is not observable
  unmatched,  ///< too few of its points have a disparity
  disagree,   ///< the points' disparities fit no line within their σ
  behind,     ///< an end's disparity is not above 0
  no_ray,     ///< an end's pixel cannot be unprojected
};

/// A description in a few words: "the disparities of its points fit no common line".
std::string_view describe(SegmentStatus status);

/// A straight edge of the left image, or a part of one, with its disparity.
struct SegmentDisparity {
  SegmentStatus status = SegmentStatus::placed;
  int segment = 0;                       ///< index into the segments
  bool is_part = false;                  ///< of a segment that was split or shortened
  ImageSegment left_px{{0, 0}, {0, 0}};  ///< rectified
  double a_disparity_px = 0, b_disparity_px = 0;
  /// Covariance from image and matcher errors, in the order a_u a_v b_u b_v a_disparity
  /// b_disparity.
  Eigen::Matrix<double, 6, 6> covariance_px2 = Eigen::Matrix<double, 6, 6>::Zero();
  /// Variances of the two disparities from noise alone, at ends held fixed along the edge: what
  /// scatters between looks at the same scene. The rest of covariance_px2 all looks share.
  Eigen::Vector2d disparity_noise_px2{0, 0};
  int edge_points = 0;      ///< of the part
  std::vector<int> points;  ///< inliers, as indices into the edges
  double rms_px = 0;        ///< RMS residual of their disparities

  /// The same edge in the right image.
  ImageSegment right_px() const {
    return {left_px.a_px - Eigen::Vector2d(a_disparity_px, 0),
            left_px.b_px - Eigen::Vector2d(b_disparity_px, 0)};
  }
};

/// Disparities of the segments of a rectified left image from those of its edge points. A straight
/// edge in space has a disparity that is linear along its image,
///
///     d(s) = d_0 + d_1 s
///
/// The line with the most consecutive matched points within `max_off_sigma` is found over pairs of
/// points; then d_0 and d_1 follow by least squares with weights 1 / σ². The points left on either
/// side are tried again, so that a segment across two surfaces is split. With H the regression its
/// covariance is
///
///     H C Hᵀ max(1, Σ r²/σ² / tr((I − P) C W)),
///     C_ij = n_i n_j max(0, 1 − |s_i − s_j| / l) + f² exp(−|s_i − s_j| / L),   n² = σ² − f²
///
/// n is the noise, correlated between points by the overlap l of their patches of 9 x 7 pixels; f
/// is the floor, correlated along the rest of the edge (measurements: docs/segments3d.md). The left
/// image's noise moves an edge and its disparity together: the covariance of both is 0.85 times the
/// variance of the edge position. An end keeps its covariance (stereo/edges/edge_segments.h), the
/// positions of both ends across the edge are correlated by their common line, and an end that
/// slides along the edge takes its disparity with it.
///
/// Results are in the order of the segments; a rejected segment has one entry, with the reason.
/// Throws Error if edges and disparities differ in number, a segment refers to a point that does
/// not exist, and for options out of range.
std::vector<SegmentDisparity> segment_disparities(const std::vector<EdgePoint>& edges,
                                                  const std::vector<EdgeSegment>& segments,
                                                  const std::vector<EdgeDisparity>& disparities,
                                                  const SegmentDisparityOptions& options = {});

}  // namespace vernier::stereo::internal
