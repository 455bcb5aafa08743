// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "sim/servo/stereo_line.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "localise/place.h"
#include "sim/noise_free_view.h"
#include "stereo/segment.h"

namespace vernier::sim::internal {

using namespace localise;
using namespace stereo;

namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Scaled as an ImageLine.
double scale_of(const Eigen::Vector3d& normal) { return normal.head<2>().norm(); }

/// The plane through an image line and its camera, and the ray of its middle.
struct LinePlane {
  ImageLine normal;
  Eigen::Vector3d middle;
};

std::optional<LinePlane> plane_through(const Camera& camera, const ImageSegment& segment) {
  const auto a = try_unproject(camera, segment.a_px), b = try_unproject(camera, segment.b_px);
  if (!a || !b) return std::nullopt;
  const Eigen::Vector3d normal = a->cross(*b);
  const double scale = scale_of(normal);
  constexpr double smallest = 1e-12;
  if (!(scale > smallest)) return std::nullopt;
  return LinePlane{normal / scale, 0.5 * (*a + *b)};
}

double angle_of(const ImageLine& line) { return std::atan2(line.y(), line.x()); }

/// Rates of the six velocities of the camera from those of a robot on the floor.
Eigen::Matrix<double, 6, 3> camera_by_floor(const Pose& T_robot_camera) {
  Eigen::Matrix<double, 6, 3> J;
  const Eigen::Matrix3d R = T_robot_camera.R.transpose();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  J.block<3, 1>(0, 0) = R.col(0);
  J.block<3, 1>(0, 1) = R.col(1);
  J.block<3, 1>(0, 2) = R * up.cross(T_robot_camera.t);
  J.bottomRows<3>().setZero();
  J.block<3, 1>(3, 2) = R * up;
  return J;
}

}  // namespace

std::optional<SeenLine> see(const Rig& told, const StereoSegment& segment) {
  constexpr double farthest_m = 30, least_sine = 0.07;
  const auto left = plane_through(told.cameras[0], segment.left);
  const auto right = plane_through(told.cameras[1], segment.right);
  if (!left || !right) return std::nullopt;
  const Pose& T = told.T_camera_first[1];
  const Eigen::Vector3d baseline = T.R.transpose() * T.t;
  const double sine =
      std::abs(left->normal.dot(baseline)) / (left->normal.norm() * baseline.norm());
  if (!(sine > least_sine)) return std::nullopt;
  const double depth = -right->normal.dot(T.t) / right->normal.dot(T.R * left->middle);
  const Eigen::Vector3d along = left->normal.cross(T.R.transpose() * right->normal);
  if (!(depth > 0 && depth < farthest_m)) return std::nullopt;
  return SeenLine{{left->normal, right->normal},
                  {depth * left->middle, along.normalized()},
                  segment.left.length_px()};
}

StereoLine image_of(const SpaceLine& line, const Pose& T_right_left) {
  const auto normal = [](const SpaceLine& l) {
    const Eigen::Vector3d n = l.point_m.cross(l.direction);
    return ImageLine(n / scale_of(n));
  };
  return {normal(line), normal(moved(line, T_right_left))};
}

SpaceLine moved(const SpaceLine& line, const Pose& T_to_from) {
  return {T_to_from * line.point_m, T_to_from.R * line.direction};
}

Eigen::Matrix<double, 2, 6> interaction(const SpaceLine& line) {
  Eigen::Vector3d N = line.point_m.cross(line.direction);
  const double scale = scale_of(N);
  N /= scale;
  const double c = N.x(), s = N.y(), rho = -N.z();
  Eigen::Matrix<double, 3, 6> dN;  // -v x u = [u]x v
  dN << hat(line.direction / scale), hat(N);
  Eigen::Matrix<double, 2, 6> L;
  L.row(0) = -dN.row(2) - rho * (c * dN.row(0) + s * dN.row(1));
  L.row(1) = c * dN.row(1) - s * dN.row(0);
  return L;
}

Eigen::Matrix<double, 4, 3> floor_interaction(const SpaceLine& line,
                                              const StereoLine& like,
                                              const Pose& T_right_left,
                                              const CameraMount& mount) {
  const Pose T_robot_left = T_robot_camera(mount);
  const auto of_eye = [](const SpaceLine& l, const ImageLine& image, const Pose& T_robot_eye) {
    Eigen::Matrix<double, 2, 3> L = interaction(l) * camera_by_floor(T_robot_eye);
    if (l.point_m.cross(l.direction).head<2>().dot(image.head<2>()) < 0) L.row(0) = -L.row(0);
    return L;
  };
  Eigen::Matrix<double, 4, 3> L;
  L << of_eye(line, like.left, T_robot_left),
      of_eye(moved(line, T_right_left), like.right, T_robot_left * T_right_left.inverse());
  return L;
}

Eigen::Vector4d difference(const StereoLine& line, const StereoLine& from) {
  const auto of_eye = [](ImageLine a, const ImageLine& b) -> Eigen::Vector2d {
    if (a.head<2>().dot(b.head<2>()) < 0) a = -a;
    return {b.z() - a.z(), std::remainder(angle_of(a) - angle_of(b), 2 * std::numbers::pi)};
  };
  Eigen::Vector4d d;
  d << of_eye(line.left, from.left), of_eye(line.right, from.right);
  return d;
}

Pose2D floor_motion(const Eigen::Vector3d& motion) {
  const double w = motion.z();
  const double a = std::abs(w) < 1e-6 ? 1 : std::sin(w) / w;
  const double b = std::abs(w) < 1e-6 ? w / 2 : (1 - std::cos(w)) / w;
  return {a * motion.x() - b * motion.y(), b * motion.x() + a * motion.y(), w};
}

Pose T_left_left(const Pose2D& to, const Pose2D& from, const CameraMount& mount) {
  return T_left_world(to, mount) * T_left_world(from, mount).inverse();
}

}  // namespace vernier::sim::internal
