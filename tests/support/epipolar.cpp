// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/epipolar.h"

#include <Eigen/Cholesky>

#include "calib/camera.h"
#include "calib/pose.h"
#include "calib/rig.h"
#include "tests/support/numeric_jacobian.h"

namespace vernier::test {

double textbook_sampson(const Rig& rig, const Eigen::Vector4d& y, double sigma) {
  const Pose& T = rig.T_camera_first[1];
  const Eigen::Matrix3d E = hat(T.t) * T.R;
  const auto constraint = [&](const Eigen::VectorXd& at) {
    const Eigen::Vector3d l = unproject(rig.cameras[0], at.head<2>());
    const Eigen::Vector3d r = unproject(rig.cameras[1], at.tail<2>());
    return Eigen::VectorXd::Constant(1, r.dot(E * l));
  };
  const Eigen::MatrixXd by_pixels = numeric_jacobian(constraint, y, 1e-3);
  return constraint(y)[0] / (sigma * by_pixels.norm());
}

double bundle_distance(const Rig& rig, const Eigen::Vector4d& y, double sigma) {
  const Pose& T = rig.T_camera_first[1];
  const Eigen::Vector3d l = unproject(rig.cameras[0], y.head<2>());
  const Eigen::Vector3d r = T.R.transpose() * unproject(rig.cameras[1], y.tail<2>());
  const Eigen::Vector3d o = -(T.R.transpose() * T.t);
  Eigen::Matrix<double, 3, 2> A;
  A << l, -r;
  const Eigen::Vector2d depth = (A.transpose() * A).ldlt().solve(A.transpose() * o);
  Eigen::Vector3d X = l * depth[0];
  double distance = 0;
  for (int round = 0; round < 30; ++round) {
    ProjectionJacobian jl, jr;
    Eigen::Vector4d e;
    e << project(rig.cameras[0], X, jl) - y.head<2>(),
        project(rig.cameras[1], T * X, jr) - y.tail<2>();
    Eigen::Matrix<double, 4, 3> J;
    J << jl.point, jr.point * T.R;
    distance = e.norm() / sigma;
    X -= (J.transpose() * J).ldlt().solve(J.transpose() * e);
  }
  return distance;
}

}  // namespace vernier::test
