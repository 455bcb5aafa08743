// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/depth_views/depth_camera.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>

#include "calib/camera.h"
#include "calib/error.h"
#include "calib/lens_models.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "localise/views/depth_view.h"
#include "sim/noise_free_view.h"
#include "sim/sense.h"
#include "sim/sources.h"
#include "sim/sources/sensed_check.h"
#include "sim/visibility.h"
#include "stereo/reconstruction/segment_disparity.h"
#include "stereo/reconstruction/space_segments.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using localise::internal::DepthSegments;
using stereo::internal::MeasuredSegment;
using stereo::internal::SegmentStatus;

namespace {

/// Of an end in an image, where the sources give none.
double sigma_of(const SourceSettings& settings) {
  return settings.endpoint_sigma_px > 0 ? settings.endpoint_sigma_px
                                        : SourceSettings{}.endpoint_sigma_px;
}

double baseline_of(const Camera& camera, double per_m2, const SourceSettings& settings) {
  if (!std::holds_alternative<Pinhole>(camera.model)) {
    throw Error("camera \"" + camera.name + "\"", "has a lens with distortion",
                "give a pinhole camera: images and depths are undistorted");
  }
  if (!(per_m2 > 0)) throw Error("depth error", "is not above 0", "use e.g. 0.0015 / m");
  return sigma_of(settings) / (camera.f_px() * camera.ax() * per_m2);
}

Rig pair_of(const Camera& camera, double baseline_m) {
  Camera right = camera;
  right.name = "right";
  return rig_of(
      {{camera, Pose{}}, {right, Pose{Eigen::Matrix3d::Identity(), {-baseline_m, 0, 0}}}});
}

}  // namespace

CameraTurn turn_of(const Eigen::Matrix3d& R_level_camera) {
  // R_level_camera = (pitch about x, down) (roll about z)
  const Eigen::Vector3d axis = R_level_camera.col(2);
  CameraTurn turn;
  turn.pitch_rad = std::atan2(axis.y(), axis.z());
  const Eigen::Matrix3d level = localise::T_robot_camera({1, 0}).R;
  const Eigen::Matrix3d pitched = localise::T_robot_camera({1, turn.pitch_rad}).R;
  const Eigen::Matrix3d roll = (level.transpose() * pitched).transpose() * R_level_camera;
  turn.roll_rad = std::atan2(roll(1, 0), roll(0, 0));
  return turn;
}

DepthCameraSensor::DepthCameraSensor(const Camera& camera,
                                     double per_m2,
                                     const SourceSettings& settings)
    : camera_(camera),
      sigma_px_(sigma_of(settings)),
      baseline_m_(baseline_of(camera, per_m2, settings)),
      eye_(pair_of(camera, 1e-6)),
      pair_(pair_of(camera, baseline_m_), settings) {}

DepthSegments DepthCameraSensor::sense(const Visibility& visibility,
                                       const localise::Pose2D& pose,
                                       const NoiseFreeViewOptions& how,
                                       const SensingDraw& draw) const {
  const StereoObservation seen = pair_.sense(look(visibility, eye_, pose, how), draw);
  require_sensed(seen);
  DepthSegments result;
  for (std::size_t i = 0; i < seen.segments.size(); ++i) {
    const stereo::StereoSegment& s = seen.segments[i];
    const auto disparity = [&](const Eigen::Vector3d& p) { return fx_px() * baseline_m_ / p.z(); };
    const double a = disparity(seen.true_edges[i].a_m), b = disparity(seen.true_edges[i].b_m);
    // what both ends share of their errors: its variance is sigma_g^2
    const double error =
        0.5 * (s.left.a_px.x() - s.right.a_px.x() - a + s.left.b_px.x() - s.right.b_px.x() - b);
    result.in_space.push_back(placed(s.left, a + error, b + error));
    result.image.push_back(s.left);
  }
  for (const stereo::ImageSegment& s : seen.left_only) {
    result.in_space.emplace_back().status = SegmentStatus::unmatched;
    result.image.push_back(s);
  }
  return result;
}

MeasuredSegment DepthCameraSensor::placed(const stereo::ImageSegment& s,
                                          double a_disparity_px,
                                          double b_disparity_px) const {
  MeasuredSegment result;
  if (!(std::min(a_disparity_px, b_disparity_px) > 0)) {
    result.status = SegmentStatus::behind;
    return result;
  }
  Eigen::Matrix<double, 6, 5> J = Eigen::Matrix<double, 6, 5>::Zero();  // by u, v, u, v, d
  for (int end = 0; end < 2; ++end) {
    const Eigen::Vector2d& px = end == 0 ? s.a_px : s.b_px;
    const double d = end == 0 ? a_disparity_px : b_disparity_px;
    const double z = fx_px() * baseline_m_ / d;
    const Eigen::Vector3d p(z * (px.x() - camera_.ox_px()) / fx_px(),
                            z * (px.y() - camera_.oy_px()) / camera_.f_px(), z);
    J(3 * end, 2 * end) = z / fx_px();
    J(3 * end + 1, 2 * end + 1) = z / camera_.f_px();
    J.block<3, 1>(3 * end, 4) = -p / d;
    (end == 0 ? result.segment.a_m : result.segment.b_m) = p;
  }
  result.independent_m2 = sigma_px_ * sigma_px_ * J * J.transpose();
  const double a_z = result.segment.a_m.z(), b_z = result.segment.b_m.z();
  const int farther = a_z > b_z ? 2 : 5;
  result.segment.depth_sigma_m = std::sqrt(result.independent_m2(farther, farther));
  const stereo::internal::SpaceSegmentOptions limits;
  result.segment.reliable = std::max(a_z, b_z) < limits.max_depth_m;
  result.relative_sigma = std::max(std::sqrt(result.independent_m2(2, 2)) / a_z,
                                   std::sqrt(result.independent_m2(5, 5)) / b_z);
  result.linear = result.relative_sigma <= limits.max_relative;
  return result;
}

}  // namespace vernier::sim::internal
