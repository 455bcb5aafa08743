// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "stereo/reconstruction/triangulate.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
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

/// The unit normal of an image line.
Eigen::Vector2d normal_of(const ImageSegment& line) {
  const Eigen::Vector2d along = (line.b_px - line.a_px).normalized();
  return {-along.y(), along.x()};
}

/// ∂(x, y) / ∂pixel of the ray (x, y, 1).
Eigen::Matrix2d ray_by_pixel(const Camera& camera, const Eigen::Vector3d& ray) {
  ProjectionJacobian J;
  project(camera, ray, J);
  return J.point.leftCols<2>().inverse();
}

/// σ_λ of the left ray's intersection at a depth with the plane of normal n (right frame), per
/// pixel of both lines; `across` is the left line's normal.
double depth_sigma(const Rig& rig,
                   const Eigen::Vector3d& ray,
                   double depth,
                   const Eigen::Vector3d& n,
                   const Eigen::Vector2d& across) {
  constexpr double least_sine = 1e-3;  // of the plane to the baseline, where depth is unknown
  const Pose& T = rig.T_camera_first[1];
  const Eigen::Vector3d in_right = depth * T.R * ray + T.t;
  if (!(in_right.z() > 0)) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d right_ray = in_right / in_right.z();
  const Eigen::RowVector2d by_left =
      depth * n.transpose() * T.R.leftCols<2>() * ray_by_pixel(rig.cameras[0], ray);
  const Eigen::RowVector2d by_right =
      in_right.z() * n.head<2>().transpose() * ray_by_pixel(rig.cameras[1], right_ray);
  const double slope = std::max(std::abs(n.dot(T.t)), least_sine * n.norm() * T.t.norm()) / depth;
  if (!(slope > 0)) return std::numeric_limits<double>::infinity();
  return std::hypot(by_left.dot(across), by_right.norm()) / slope;
}

}  // namespace

SpaceSegment triangulate(const Rig& rig,
                         const StereoSegment& segment,
                         const TriangulationOptions& options) {
  require_pair(rig);
  const Camera &left = rig.cameras[0], &right = rig.cameras[1];
  const Pose& T_right_left = rig.T_camera_first[1];
  SpaceSegment result;
  bool all_have_rays = true;
  // An erroneous rig may be unable to unproject a pixel; any direction is used then.
  const auto ray_of = [&](const Camera& camera, const Eigen::Vector2d& pixel) -> Eigen::Vector3d {
    if (const auto ray = try_unproject(camera, pixel)) return *ray;
    all_have_rays = false;
    result.reliable = false;
    return Eigen::Vector3d::UnitZ();
  };
  const Eigen::Vector3d n =
      ray_of(right, segment.right.a_px).cross(ray_of(right, segment.right.b_px));
  const double offset = n.dot(T_right_left.t);
  double depth[2];
  Eigen::Vector3d rays[2];
  for (int end = 0; end < 2; ++end) {
    rays[end] = ray_of(left, end == 0 ? segment.left.a_px : segment.left.b_px);
    depth[end] = -offset / n.dot(T_right_left.R * rays[end]);
    if (!(depth[end] > 0 && depth[end] < options.max_depth_m)) {
      result.reliable = false;
      depth[end] = options.max_depth_m;
    }
    const Eigen::Vector3d in_right = depth[end] * T_right_left.R * rays[end] + T_right_left.t;
    if (!(in_right.z() > 0)) result.reliable = false;
  }
  result.a_m = depth[0] * rays[0];
  result.b_m = depth[1] * rays[1];
  const int farther = depth[1] > depth[0] ? 1 : 0;
  result.depth_sigma_m =
      all_have_rays ? options.endpoint_sigma_px * depth_sigma(rig, rays[farther], depth[farther], n,
                                                              normal_of(segment.left))
                    : std::numeric_limits<double>::infinity();
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
