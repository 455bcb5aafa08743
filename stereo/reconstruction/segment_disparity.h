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
  double min_angle_rad = 0.0873;   ///< segments nearer to the row (5°) are refused
  int min_points = 6;              ///< matched points that agree on one line
  double min_share = 0.5;          ///< of them among a part's edge points
  double max_off_sigma = 3;        ///< farther from the line a point disagrees
  double reach_px = 8;             ///< beyond its agreeing points no part goes on further …
  double end_sigma_px = 3;         ///< … and an end that is put there is known so along the line
  double unstated_sigma_px = 0.5;  ///< of disparities whose matcher states none
  double floor_px = 0.2;           ///< part of the stated σ that is no noise but the scene's …
  double floor_length_px = 30;     ///< … and shared along an edge as exp(−distance / this)
  double scale_px = 1;             ///< of canny_edges
};

/// What became of a segment.
enum class SegmentStatus {
  placed,
  along_row,  ///< too near to the row: a disparity of it says nothing
  unmatched,  ///< too few of its points have a disparity
  disagree,   ///< the points' disparities are on no line, by their σ
  behind,     ///< an end's disparity is not above 0
  no_ray,     ///< an end's pixel has no ray under the rig
};

/// In a few words: "its points' disparities agree on no line".
std::string_view describe(SegmentStatus status);

/// A straight edge of the left image, or a part of one, with its disparity.
struct SegmentDisparity {
  SegmentStatus status = SegmentStatus::placed;
  int segment = 0;                       ///< its place in the list of segments
  bool is_part = false;                  ///< of a segment that was split or drawn in
  ImageSegment left_px{{0, 0}, {0, 0}};  ///< rectified
  double a_disparity_px = 0, b_disparity_px = 0;
  /// Of the image's and the matcher's errors, in the order a_u a_v b_u b_v a_disparity b_disparity.
  Eigen::Matrix<double, 6, 6> covariance_px2 = Eigen::Matrix<double, 6, 6>::Zero();
  int edge_points = 0;      ///< of the part
  std::vector<int> points;  ///< those that agree on the line, by their places in the list of edges
  double rms_px = 0;        ///< of their disparities from the line

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
/// The line that most matched points in a row are on, within `max_off_sigma`, is found over pairs
/// of them; then d_0 and d_1 by least squares of weights 1 / σ². What is left on either side is
/// tried again, so that a segment over two surfaces is split. With H the regression its covariance
/// is
///
///     H C Hᵀ max(1, Σ r²/σ² / tr((I − P) C W)),
///     C_ij = n_i n_j max(0, 1 − |s_i − s_j| / l) + f² exp(−|s_i − s_j| / L),   n² = σ² − f²
///
/// n is the noise, which points share by the overlap l of their patches of 9 x 7 pixels, f the
/// floor, which they share with the rest of the edge (docs/segments3d.md has the measurements). The
/// left image's noise moves an edge and its disparity alike: the covariance of both is 0.85 times
/// the variance of the edge's place. An end keeps its covariance (stereo/edges/edge_segments.h),
/// both ends' places across are correlated by their common line, and an end that slides along the
/// edge takes its disparity with it.
///
/// In the order of the segments; refused ones are listed once, with the reason. Throws Error where
/// edges and disparities differ in number, a segment has a point that is none of them, and on
/// options out of range.
std::vector<SegmentDisparity> segment_disparities(const std::vector<EdgePoint>& edges,
                                                  const std::vector<EdgeSegment>& segments,
                                                  const std::vector<EdgeDisparity>& disparities,
                                                  const SegmentDisparityOptions& options = {});

}  // namespace vernier::stereo::internal
