// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "localise/join/place_segments.h"

#include <Eigen/Core>

#include "calib/pose.h"
#include "localise/joined_lines.h"
#include "localise/place.h"

namespace vernier::localise::internal {

SegmentsOfView segments_of_place(const PlaceView& view, const Pose2D& pose) {
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  constexpr double least_m = 0.001, per_m = 0.002;
  SegmentsOfView result;
  result.T_world_camera = {rotation_from_vector({0, 0, pose.heading_rad}), {pose.x_m, pose.y_m, 0}};
  const Vector3d eye(0, 0, view.mount.height_m);
  for (const PlaceLine& line : view.lines) {
    SightedSegment segment{line.a_m, line.b_m, Eigen::Matrix<double, 6, 6>::Zero()};
    const Vector3d to_a = line.a_m - eye, to_b = line.b_m - eye;
    const Vector3d a = to_a.normalized(), b = to_b.normalized();
    const auto covariance = [&](const Vector3d& to, const Vector3d& ray) -> Matrix3d {
      const double across = least_m + per_m * to.norm();
      return across * across * Matrix3d::Identity() +
             line.sigma_m * line.sigma_m * ray * ray.transpose();
    };
    segment.covariance_m2.topLeftCorner<3, 3>() = covariance(to_a, a);
    segment.covariance_m2.bottomRightCorner<3, 3>() = covariance(to_b, b);
    if (line.kind == LineKind::vertical) {
      const Matrix3d common = line.sigma_m * line.sigma_m * a * b.transpose();
      segment.covariance_m2.topRightCorner<3, 3>() = common;
      segment.covariance_m2.bottomLeftCorner<3, 3>() = common.transpose();
    }
    result.segments.push_back(segment);
  }
  return result;
}

}  // namespace vernier::localise::internal
