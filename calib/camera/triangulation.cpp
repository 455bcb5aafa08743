// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/triangulation.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "calib/camera.h"
#include "calib/camera/other_camera.h"
#include "calib/camera/ray_derivatives.h"
#include "calib/error.h"
#include "calib/pose.h"
#include "calib/rig.h"

namespace vernier {

using namespace internal;

void internal::check_other(const Rig& rig, int other) {
  const auto cameras = std::min(rig.cameras.size(), rig.T_camera_first.size());
  if (other > 0 && other < static_cast<int>(cameras)) return;
  throw Error("triangulation",
              "the rig has " + std::to_string(cameras) +
                  " camera(s) with a pose, so the first cannot be paired with number " +
                  std::to_string(other),
              "give a rig of two or more");
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Rays and the second camera's centre in the first camera's frame, with the lengths along the
/// rays.
struct Rays {
  Vector3d v0, v1, t;
  double l0 = 0, l1 = 0;

  Vector3d middle() const { return 0.5 * (l0 * v0 + t + l1 * v1); }

  bool meet_in_front() const {
    const Vector3d a = l0 * v0, b = l1 * v1;
    const double gap = (t + b - a).squaredNorm();
    return gap < std::min({(t + b + a).squaredNorm(), (t - b - a).squaredNorm(),
                           (t - b + a).squaredNorm()});
  }
};

std::optional<Rays> rays_of(const Rig& rig, const PixelPair& pair, int other) {
  check_other(rig, other);
  const auto first = try_unproject(rig.cameras[0], pair.first_px);
  const auto second = try_unproject(rig.cameras[other], pair.other_px);
  if (!first || !second) return std::nullopt;
  const Pose& T = rig.T_camera_first[other];
  Rays rays{*first, T.R.transpose() * *second, -(T.R.transpose() * T.t)};
  const double c = rays.v0.cross(rays.v1).norm();
  if (!(c > 0)) return std::nullopt;
  rays.l0 = rays.v1.cross(rays.t).norm() / c;
  rays.l1 = rays.v0.cross(rays.t).norm() / c;
  if (!rays.meet_in_front()) return std::nullopt;
  return rays;
}

/// d|w| / dw, a row; zero if w vanishes.
Eigen::RowVector3d unit_row(const Vector3d& w) {
  const double n = w.norm();
  return n > 0 ? Eigen::RowVector3d(w.transpose() / n) : Eigen::RowVector3d::Zero();
}

/// Derivatives of the midpoint with respect to v0, v1 and t.
struct MiddleDerivatives {
  Matrix3d by_v0, by_v1, by_t;
};

MiddleDerivatives derivatives_of_middle(const Rays& r) {
  const Vector3d c = r.v0.cross(r.v1), a = r.v1.cross(r.t), b = r.v0.cross(r.t);
  const Eigen::RowVector3d c_row = unit_row(c), a_row = unit_row(a), b_row = unit_row(b);
  const double inverse = 1 / c.norm();
  // d(v × w) = -[w]x dv + [v]x dw
  const Eigen::RowVector3d c_by_v0 = -c_row * hat(r.v1), c_by_v1 = c_row * hat(r.v0);
  const Eigen::RowVector3d l0_by_v0 = -r.l0 * inverse * c_by_v0;
  const Eigen::RowVector3d l0_by_v1 = inverse * (-a_row * hat(r.t) - r.l0 * c_by_v1);
  const Eigen::RowVector3d l0_by_t = inverse * a_row * hat(r.v1);
  const Eigen::RowVector3d l1_by_v0 = inverse * (-b_row * hat(r.t) - r.l1 * c_by_v0);
  const Eigen::RowVector3d l1_by_v1 = -r.l1 * inverse * c_by_v1;
  const Eigen::RowVector3d l1_by_t = inverse * b_row * hat(r.v0);
  const Matrix3d I = Matrix3d::Identity();
  return {0.5 * (r.l0 * I + r.v0 * l0_by_v0 + r.v1 * l1_by_v0),
          0.5 * (r.l1 * I + r.v0 * l0_by_v1 + r.v1 * l1_by_v1),
          0.5 * (I + r.v0 * l0_by_t + r.v1 * l1_by_t)};
}

void check_two_cameras(const Rig& rig) {
  if (rig.cameras.size() == 2) return;
  throw Error("triangulation", "the rig has " + std::to_string(rig.cameras.size()) + " cameras",
              "give a rig of two");
}

/// Depth of the point on the left ray closest to the right ray.
double depth_of(const Rig& rig, const Eigen::Vector3d& a, const Eigen::Vector3d& right_ray) {
  const Pose T_left_right = rig.T_camera_first[1].inverse();
  const Eigen::Vector3d b = T_left_right.R * right_ray;
  // least squares for λ a = t + μ b
  Eigen::Matrix<double, 3, 2> A;
  A << a, -b;
  const Eigen::Vector2d scale = (A.transpose() * A).ldlt().solve(A.transpose() * T_left_right.t);
  return scale[0] * a.z();
}

}  // namespace

std::optional<Vector3d> triangulate_point(const Rig& rig, const PixelPair& pair, int other) {
  const auto rays = rays_of(rig, pair, other);
  if (!rays) return std::nullopt;
  return rays->middle();
}

std::optional<PointTriangulation> triangulate_point_with_jacobian(const Rig& rig,
                                                                  const PixelPair& pair,
                                                                  int other) {
  const auto rays = rays_of(rig, pair, other);
  if (!rays) return std::nullopt;
  const Pose& T = rig.T_camera_first[other];
  const Matrix3d Rt = T.R.transpose();
  const Vector3d ray_other = T.R * rays->v1;  // (x, y, 1) of the other camera
  const RayDerivatives first = derivatives_of_ray(rig.cameras[0], rays->v0);
  const RayDerivatives second = derivatives_of_ray(rig.cameras[other], ray_other);
  const MiddleDerivatives d = derivatives_of_middle(*rays);

  PointTriangulation result;
  result.x_m = rays->middle();
  result.by_pixels.leftCols<2>() = d.by_v0 * first.by_pixel;
  result.by_pixels.rightCols<2>() = d.by_v1 * Rt * second.by_pixel;
  result.by_rig = Eigen::MatrixXd::Zero(3, parameter_count(rig));
  result.by_rig.middleCols(0, first.by_camera.cols()) = d.by_v0 * first.by_camera;
  result.by_rig.middleCols(intrinsics_index(rig, other), second.by_camera.cols()) =
      d.by_v1 * Rt * second.by_camera;
  // v1 = Rᵀ ray and t = -Rᵀ T with R -> exp(w) R, T -> T + τ: δv1 = Rᵀ [ray]x w,
  // δt = -Rᵀ [T]x w - Rᵀ τ
  const int pose = pose_index(rig, other);
  result.by_rig.middleCols<3>(pose) = d.by_v1 * Rt * hat(ray_other) - d.by_t * Rt * hat(T.t);
  result.by_rig.middleCols<3>(pose + 3) = -d.by_t * Rt;
  return result;
}

std::optional<PixelPair> pixel_pair(const Rig& rig, const Vector3d& x_m, int other) {
  check_other(rig, other);
  const Vector3d x_other = rig.T_camera_first[other] * x_m;
  if (!(x_m.z() > 0) || !(x_other.z() > 0)) return std::nullopt;
  return PixelPair{project(rig.cameras[0], x_m), project(rig.cameras[other], x_other)};
}

double triangulated_depth_m(const Rig& rig, const PixelPair& pair) {
  check_two_cameras(rig);
  return depth_of(rig, unproject(rig.cameras[0], pair.first_px),
                  unproject(rig.cameras[1], pair.other_px));
}

std::optional<double> try_triangulated_depth_m(const Rig& rig, const PixelPair& pair) {
  check_two_cameras(rig);
  const auto left = try_unproject(rig.cameras[0], pair.first_px);
  const auto right = try_unproject(rig.cameras[1], pair.other_px);
  if (!left || !right) return std::nullopt;
  return depth_of(rig, *left, *right);
}

}  // namespace vernier
