// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "localise/views/depth_view.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/visibility.h"
#include "stereo/reconstruction/space_segments.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

/// How a camera is turned on a robot that faces where it looks: what T_left_world() takes.
struct CameraTurn {
  double pitch_rad = 0;  ///< positive: down
  double roll_rad = 0;   ///< positive: clockwise as seen from behind
};
CameraTurn turn_of(const Eigen::Matrix3d& R_level_camera);

/// A camera with a depth map aligned with its image (RGB-D), simulated with the sources of a rig.
///
/// It sees with one eye: nothing is hidden from a second. Its depths err as those of a pair of such
/// cameras whose baseline B gives the stated error: an end of an edge has the disparity d = f B /
/// z, and both ends of an edge share one error, as its pixels do (localise/views/depth_view.h): the
/// mean of the errors of both ends in both cameras, with the standard deviation of one of them, σ_g
/// (`endpoint_sigma_px`). This is per_m2 z² in depth for
///
///     B = σ_g / (f per_m2)
///
/// So edges go through the sources of this pair, of which `stereo_mismatch` are wrong depths. An
/// edge along a row is as good as any: `epipolar_reject_deg` should be 0.
class DepthCameraSensor {
 public:
  /// Throws Error unless the camera is a pinhole, for a depth error that is not above 0, and for
  /// settings out of range.
  DepthCameraSensor(const Camera& camera, double per_m2, const SourceSettings& settings);

  /// Throws Error if a source of one's own fails.
  localise::internal::DepthSegments sense(const Visibility& visibility,
                                          const localise::Pose2D& pose,
                                          const NoiseFreeViewOptions& how,
                                          const SensingDraw& draw) const;

  double baseline_m() const { return baseline_m_; }

 private:
  double fx_px() const { return camera_.f_px() * camera_.ax(); }
  /// A segment whose ends have these disparities, with its covariance.
  stereo::internal::MeasuredSegment placed(const stereo::ImageSegment& image_px,
                                           double a_disparity_px,
                                           double b_disparity_px) const;

  Camera camera_;
  double sigma_px_, baseline_m_;
  Rig eye_;
  Sensor pair_;
};

}  // namespace vernier::sim::internal
