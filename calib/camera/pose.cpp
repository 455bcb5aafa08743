// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "calib/pose.h"

#include <Eigen/Geometry>
#include <cmath>

namespace vernier {

Eigen::Matrix3d hat(const Eigen::Vector3d& w) {
  Eigen::Matrix3d W;
  W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return W;
}

Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = hat(w);
  if (angle < 1e-8) return Eigen::Matrix3d::Identity() + W + 0.5 * W * W;
  const double half_sine = std::sin(0.5 * angle) / angle;
  return Eigen::Matrix3d::Identity() + std::sin(angle) / angle * W +
         2 * half_sine * half_sine * W * W;
}

Eigen::Vector3d vector_from_rotation(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  // 2 atan2(s, c) / s, by its series if s vanishes.
  const double scale = sine < 1e-9 ? 2.0 / q.w() : 2.0 * std::atan2(sine, q.w()) / sine;
  return scale * q.vec();
}

Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = hat(w);
  if (angle < 1e-5) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  const double a2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / a2 * W +
         (angle - std::sin(angle)) / (a2 * angle) * W * W;
}

Pose retract(const Pose& T, const Eigen::Matrix<double, 6, 1>& delta) {
  return {rotation_from_vector(delta.head<3>()) * T.R, T.t + delta.tail<3>()};
}

}  // namespace vernier
