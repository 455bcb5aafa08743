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
  double max_depth_m = 30;    ///< beyond it a segment is marked unreliable (stereo/segment.h)
  double max_relative = 0.1;  ///< σ_z / z of an end above which its covariance is doubtful
};

/// A segment in space with what is known of it: both end points, a over b, in metres in the left
/// camera's frame (not the rectified one, which is R_rectified_left times it).
struct MeasuredSegment {
  SegmentStatus status = SegmentStatus::placed;  ///< else nothing of the rest is known
  SpaceSegment segment;                          ///< its depth_sigma_m is of the independent part
  /// Of the image's and the matcher's own errors: new for every segment.
  Eigen::Matrix<double, 6, 6> independent_m2 = Eigen::Matrix<double, 6, 6>::Zero();
  /// ∂ends / ∂rig in the tangent and order of calib/rig.h; no columns without a rig.
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_rig;
  /// by_rig C by_rigᵀ, of the rig's errors, which all segments share; 0 without a covariance.
  Eigen::Matrix<double, 6, 6> calibration_m2 = Eigen::Matrix<double, 6, 6>::Zero();
  /// Largest σ_z / z of both ends, both parts together.
  double relative_sigma = 0;
  /// σ_z / z is so small that a linear covariance tells the distribution.
  bool linear = true;

  Eigen::Matrix<double, 6, 6> covariance_m2() const { return independent_m2 + calibration_m2; }
};

/// Puts segments into space, one for each; those refused before stay so, and an end may turn out
/// to be `behind` the rig. In the rectified left camera's frame an end is
///
///     p = f B / d ((u − c_x) / f, (v − c_y) / f, 1),   ∂p/∂u = z/f e_x,  ∂p/∂v = z/f e_y,
///     ∂p/∂d = −p / d
///
/// so that independent = J C Jᵀ with C of the places and disparities
/// (stereo/reconstruction/segment_disparity.h), turned into the left camera's frame.
std::vector<MeasuredSegment> space_segments(std::span<const SegmentDisparity> segments,
                                            const RectifiedGeometry& geometry,
                                            const SpaceSegmentOptions& options = {});

/// The same with what the rig does, whose `geometry` it is. The raw images stay: the left ends'
/// raw pixels, and the raw pixels of the right line. Another rig reads another line in space from
/// them, the intersection of stereo/reconstruction/triangulate.h, whose derivatives by_rig are: all
/// that rectification and triangulation do with the rig's errors, the vertical ones at slanted
/// edges included. A repair of the vertical field is not in it. Throws Error where the estimate's
/// covariance is not of its rig.
std::vector<MeasuredSegment> space_segments(std::span<const SegmentDisparity> segments,
                                            const RectifiedGeometry& geometry,
                                            const RigEstimate& estimate,
                                            const SpaceSegmentOptions& options = {});

/// J C Jᵀ over the by_rig of any number of segments: 6 rows a segment. What they have in common,
/// so that a length or an angle between two of them has the variance that it has. Throws Error on
/// segments without by_rig or of another rig.
Eigen::MatrixXd calibration_covariance_m2(std::span<const MeasuredSegment> segments,
                                          const Eigen::MatrixXd& rig_covariance);

}  // namespace vernier::stereo::internal
