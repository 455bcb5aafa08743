// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace vernier {

/// A rigid transform. Named `T_a_b`, it maps coordinates in b to coordinates in a:
///
///     x_a = T_a_b * x_b = R x_b + t
struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< metres

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return R * x + t; }
  Pose operator*(const Pose& T) const { return {R * T.R, R * T.t + t}; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
};

/// [w]x, the matrix with hat(w) v = w x v.
Eigen::Matrix3d hat(const Eigen::Vector3d& w);

/// Rotation matrix of the rotation vector w (radians): Rodrigues' formula.
Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& w);

/// Rotation vector (radians, angle in [0, pi]) of a rotation matrix; the inverse of the above.
Eigen::Vector3d vector_from_rotation(const Eigen::Matrix3d& R);

/// Left Jacobian J_l(w) of SO(3): exp(w + dw) = exp(J_l(w) dw) exp(w) to first order, so it maps an
/// additive change of a rotation vector to the left tangent. Solà, Deray and Atchuthan, "A micro
/// Lie theory for state estimation in robotics" (2018), Eq. (145).
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w);

/// Update in the left tangent: R becomes exp(delta[0..2]) R and t becomes t + delta[3..5].
Pose retract(const Pose& T, const Eigen::Matrix<double, 6, 1>& delta);

}  // namespace vernier
