// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/reconstruction/triangulate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "calib/camera.h"
#include "calib/camera/ray_derivatives.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "stereo/segment.h"

namespace vernier::stereo::internal {

using namespace vernier::internal;

namespace {

void require_pair(const Rig& rig) {
  if (rig.cameras.size() != 2) {
    throw Error("triangulation", "the rig has " + std::to_string(rig.cameras.size()) + " cameras",
                "use a rig of two cameras");
  }
}

/// Standard deviation of the depth at the end of a line. An error e across the right line moves it
/// by e / sin(angle to the baseline) along the baseline, and dZ = Z² / (f b) per pixel of that.
double depth_sigma(double depth, double sine, const Rig& rig, double sigma_px) {
  const double baseline = rig.T_camera_first[1].t.norm();
  const double both_lines = std::sqrt(2.0) * sigma_px / std::max(sine, 1e-3);
  return depth * depth * both_lines / (rig.cameras[0].f_px() * baseline);
}

}  // namespace

SpaceSegment triangulate(const Rig& rig,
                         const StereoSegment& segment,
                         const TriangulationOptions& options) {
  require_pair(rig);
  const Camera &left = rig.cameras[0], &right = rig.cameras[1];
  const Pose& T_right_left = rig.T_camera_first[1];
  SpaceSegment result;
  // An erroneous rig may be unable to unproject a pixel; any direction is used then.
  const auto ray_of = [&](const Camera& camera, const Eigen::Vector2d& pixel) -> Eigen::Vector3d {
    if (const auto ray = try_unproject(camera, pixel)) return *ray;
    result.reliable = false;
    return Eigen::Vector3d::UnitZ();
  };
  const Eigen::Vector3d n =
      ray_of(right, segment.right.a_px).cross(ray_of(right, segment.right.b_px));
  const double offset = n.dot(T_right_left.t);
  const auto place = [&](const Eigen::Vector2d& pixel) -> Eigen::Vector3d {
    const Eigen::Vector3d ray = ray_of(left, pixel);
    const double slope = n.dot(T_right_left.R * ray);
    const double depth = -offset / slope;
    if (depth > 0 && depth < options.max_depth_m) return depth * ray;
    result.reliable = false;
    return options.max_depth_m * ray;
  };
  result.a_m = place(segment.left.a_px);
  result.b_m = place(segment.left.b_px);

  const Eigen::Vector2d direction = segment.left.b_px - segment.left.a_px;
  const double sine = std::abs(direction.y()) / std::max(direction.norm(), 1e-12);
  const double farther = std::max(result.a_m.z(), result.b_m.z());
  result.depth_sigma_m = depth_sigma(farther, sine, rig, options.endpoint_sigma_px);
  return result;
}

std::vector<SpaceSegment> triangulate(const Rig& rig,
                                      std::span<const StereoSegment> segments,
                                      const TriangulationOptions& options) {
  std::vector<SpaceSegment> placed;
  placed.reserve(segments.size());
  for (const StereoSegment& segment : segments)
    placed.push_back(triangulate(rig, segment, options));
  return placed;
}

std::optional<SegmentTriangulation> triangulate_with_jacobian(const Rig& rig,
                                                              const StereoSegment& segment) {
  using Eigen::Vector3d;
  require_pair(rig);
  const Camera &left = rig.cameras[0], &right = rig.cameras[1];
  const Pose& T = rig.T_camera_first[1];
  const auto r1 = try_unproject(right, segment.right.a_px);
  const auto r2 = try_unproject(right, segment.right.b_px);
  if (!r1 || !r2) return std::nullopt;
  const Vector3d n = r1->cross(*r2);
  const auto by_right_1 = derivatives_of_ray(right, *r1).by_camera;
  const auto by_right_2 = derivatives_of_ray(right, *r2).by_camera;
  SegmentTriangulation result;
  result.by_rig.setZero(6, parameter_count(rig));
  for (int end = 0; end < 2; ++end) {
    const auto r = try_unproject(left, end == 0 ? segment.left.a_px : segment.left.b_px);
    if (!r) return std::nullopt;
    const Vector3d q = T.R * *r;
    const double slope = n.dot(q), depth = -n.dot(T.t) / slope;
    if (!(depth > 0) || !std::isfinite(depth)) return std::nullopt;
    const Vector3d w = depth * q + T.t;
    const auto by_left = derivatives_of_ray(left, *r).by_camera;
    Eigen::RowVectorXd depth_by_rig = Eigen::RowVectorXd::Zero(parameter_count(rig));
    depth_by_rig.head(by_left.cols()) = depth * n.transpose() * T.R * by_left;
    depth_by_rig.segment(intrinsics_index(rig, 1), by_right_1.cols()) =
        r2->cross(w).transpose() * by_right_1 + w.cross(*r1).transpose() * by_right_2;
    depth_by_rig.segment<3>(pose_index(rig, 1)) = depth * q.cross(n).transpose();
    depth_by_rig.segment<3>(pose_index(rig, 1) + 3) = n.transpose();
    result.ends_m.segment<3>(3 * end) = depth * *r;
    auto by_rig = result.by_rig.middleRows<3>(3 * end);
    by_rig = *r * (-1 / slope * depth_by_rig);
    by_rig.leftCols(by_left.cols()) += depth * by_left;
  }
  return result;
}

}  // namespace vernier::stereo::internal
