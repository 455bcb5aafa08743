// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/rig_estimate.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/rectification.h"
#include "stereo/segment.h"

namespace vernier::stereo::internal {

struct SpaceSegmentOptions {
  double max_depth_m = 30;  ///< segments beyond are marked unreliable (stereo/segment.h)
  /// Σ_z / z of an end above which the linear covariance is not reliable.
  double max_relative = 0.1;
};

/// A segment in space with its uncertainty: both end points, a then b, in metres in the left camera
/// frame (not the rectified one, which is R_rectified_left times it).
struct MeasuredSegment {
  SegmentStatus status = SegmentStatus::placed;  ///< if not placed, the other fields are not set
  SpaceSegment segment;                          ///< its depth_sigma_m is of the independent part
  /// Covariance from image and matcher errors, independent between segments.
  Eigen::Matrix<double, 6, 6> independent_m2 = Eigen::Matrix<double, 6, 6>::Zero();
  /// ∂ends / ∂rig in the tangent and order of calib/rig.h; no columns without a rig.
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_rig;
  /// by_rig C by_rigᵀ, from the rig's errors, which are common to all segments; 0 without a
  /// covariance.
  Eigen::Matrix<double, 6, 6> calibration_m2 = Eigen::Matrix<double, 6, 6>::Zero();
  /// Larger σ_z / z of the two ends, from both covariances.
  double relative_sigma = 0;
  /// Whether σ_z / z is small enough for the linear covariance to be reliable.
  bool linear = true;

  Eigen::Matrix<double, 6, 6> covariance_m2() const { return independent_m2 + calibration_m2; }
};

/// `placed`, or why a segment has no place in space: rejected, or an end that is behind the rig.
SegmentStatus status_in_space(const SegmentDisparity& segment);

/// States the independent error of a segment whose ends are set, by their derivatives J with
/// respect to what C is the covariance of (stereo/reconstruction/segment_disparity.h).
void state_independent_error(MeasuredSegment& segment,
                             const Eigen::Matrix<double, 6, 6>& J,
                             const Eigen::Matrix<double, 6, 6>& C_px2,
                             const SpaceSegmentOptions& options);

/// Sets relative_sigma and linear by both covariances.
void judge_linearity(MeasuredSegment& segment, const SpaceSegmentOptions& options);

/// Reconstructs segments, one result per input; rejected ones stay rejected, and an end may turn
/// out to be `behind` the rig. In the rectified left camera frame an end is
///
///     p = f B / d ((u − c_x) / f, (v − c_y) / f, 1),   ∂p/∂u = z/f e_x,  ∂p/∂v = z/f e_y,
///     ∂p/∂d = −p / d
///
/// so that independent = J C Jᵀ with C the covariance of positions and disparities
/// (stereo/reconstruction/segment_disparity.h), rotated to the left camera frame.
std::vector<MeasuredSegment> space_segments(std::span<const SegmentDisparity> segments,
                                            const RectifiedGeometry& geometry,
                                            const SpaceSegmentOptions& options = {});

/// The same with derivatives by the rig to which `geometry` belongs. The raw images are held fixed:
/// the raw pixels of the left ends and of the right line. With another rig they give another line
/// in space, the intersection of stereo/reconstruction/triangulate.h, and by_rig holds its
/// derivatives: the full effect of rig errors through rectification and triangulation, including
/// vertical errors at slanted edges. A correction of the vertical field is not included. Throws
/// Error if the estimate's covariance does not match its rig.
std::vector<MeasuredSegment> space_segments(std::span<const SegmentDisparity> segments,
                                            const RectifiedGeometry& geometry,
                                            const RigEstimate& estimate,
                                            const SpaceSegmentOptions& options = {});

/// J C Jᵀ over the by_rig of any number of segments, 6 rows per segment: the joint covariance, as
/// needed for a length or an angle between two of them. Throws Error for segments without by_rig or
/// with that of another rig.
Eigen::MatrixXd calibration_covariance_m2(std::span<const MeasuredSegment> segments,
                                          const Eigen::MatrixXd& rig_covariance);

}  // namespace vernier::stereo::internal
